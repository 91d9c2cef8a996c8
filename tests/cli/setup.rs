//! ci/setup finds the machine's own Debian archive in whatever form its sources are written.

use std::path::Path;
use std::process::Command;

const ONE_LINE: &str = "\
# deb http://comment.invalid/debian bookworm main
deb http://security.invalid/debian-security bookworm-security main
deb [arch=amd64 signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] http://mirror.invalid/debian bookworm main contrib
deb http://later.invalid/debian bookworm main
";

const DEB822: &str = "\
Types: deb
Enabled: no
URIs: http://disabled.invalid/debian
Suites: bookworm
Components: main

Types: deb deb-src
URIs: http://mirror.invalid/debian
Suites: bookworm-updates
 bookworm
Components: main
Signed-By: /usr/share/keyrings/debian-archive-keyring.gpg
";

const BY_STATUS: &str = "deb http://mirror.invalid/debian stable main\n";

const OTHERS: &str = "deb http://elsewhere.invalid/apt nodistro main\n";

/// What ci/setup takes for the archive of bookworm, with `content` as the machine's only sources.
fn archive(file_name: &str, content: &str) -> String {
    let directory = tempfile::tempdir().unwrap();
    let parts = directory.path().join("parts");
    std::fs::create_dir(&parts).unwrap();
    std::fs::write(parts.join(file_name), content).unwrap();
    let apt_config = directory.path().join("apt.conf");
    let settings = format!("Dir::Etc::SourceList \"/dev/null\"; Dir::Etc::SourceParts \"{}\";", parts.display());
    std::fs::write(&apt_config, settings).unwrap();
    let output = Command::new("bash")
        .args(["-c", "source ci/setup && archive_of bookworm"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .env("APT_CONFIG", &apt_config)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn setup_finds_the_archive_in_both_formats_of_apt_sources() {
    if !Path::new("/usr/bin/apt-get").exists() {
        println!("skipped: no apt on this machine");
        return;
    }
    assert_eq!(archive("a.list", ONE_LINE), "http://mirror.invalid/debian/\n");
    assert_eq!(archive("a.sources", DEB822), "http://mirror.invalid/debian/\n");
    assert_eq!(archive("a.list", BY_STATUS), "http://mirror.invalid/debian/\n");
    assert_eq!(archive("a.list", OTHERS), "");
}
