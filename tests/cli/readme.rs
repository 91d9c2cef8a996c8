//! README.md tells of what there is.

use super::run;

const README: &str = include_str!("../../README.md");

#[test]
fn readme_names_every_option_of_every_subcommand() {
    let directory = tempfile::tempdir().unwrap();
    for subcommand in ["render", "inspect", "devices", "diff", "bench", "bench-compare", "report"] {
        let help = run(directory.path(), &[subcommand, "--help"]).stdout;
        let words = help.split(|c: char| c.is_whitespace() || "`'[],.;:".contains(c));
        // --verbose, --quiet, --help and --version are every program's.
        let own = words.filter(|word| word.starts_with("--") && !["--verbose", "--quiet", "--help", "--version", "--"].contains(word));
        for option in own {
            assert!(README.contains(option.trim_end_matches('.')), "README.md does not name {option} of {subcommand}");
        }
    }
}

#[test]
fn readme_names_the_two_commands() {
    assert!(README.contains("./ci/demo") && README.contains("./ci/test"));
}
