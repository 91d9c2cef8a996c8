//! Files and results that leave the program: whole, or not at all.

use crate::display::{ExrContents, ToneMapping};
use anyhow::{Context, bail};
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Writes a file beside its place and renames it there once `write` has succeeded, so that whoever looks sees the old
/// file or the whole new one. Nothing is left behind after an error.
pub fn write_atomically<E>(path: &Path, write: impl FnOnce(&mut BufWriter<NamedTempFile>) -> Result<(), E>) -> anyhow::Result<()>
where
    E: Into<anyhow::Error>,
{
    let cannot_write = || format!("cannot write '{}'", path.display());
    let mut file = BufWriter::new(temporary_beside(path).with_context(cannot_write)?);
    write(&mut file).map_err(Into::into).with_context(cannot_write)?;
    let file = file.into_inner().map_err(|error| error.into_error()).with_context(cannot_write)?;
    file.persist(path).map_err(|error| error.error).with_context(cannot_write)?;
    Ok(())
}

/// Writes an .exr with all of `contents`, or a .png of its main image. Non-finite values are reported and become 0.
pub fn write_picture(path: &Path, contents: &ExrContents, mapping: &ToneMapping) -> anyhow::Result<()> {
    let shown = path.display();
    let image = contents.image.made_finite(&format!("'{shown}'"));
    let beside: Vec<_> = contents.beside.iter().map(|(name, image)| (*name, image.made_finite(&format!("'{shown}', {name}")))).collect();
    let beside: Vec<_> = beside.iter().map(|(name, image)| (*name, image.as_ref())).collect();
    write_atomically(path, |file| match path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        true => image.write_png(mapping, file),
        false => ExrContents { image: &image, beside: &beside, ..*contents }.write(file),
    })
}

/// Finds out before the long work whether all of `paths` can be written, and that no two are one file.
pub fn check_writable<'a>(paths: impl IntoIterator<Item = &'a Path>) -> anyhow::Result<()> {
    let mut seen: Vec<PathBuf> = Vec::new();
    for path in paths {
        temporary_beside(path).with_context(|| format!("cannot write '{}'", path.display()))?;
        let place = std::path::absolute(path)?;
        if seen.contains(&place) {
            bail!("'{}' is named twice as an output", path.display());
        }
        seen.push(place);
    }
    Ok(())
}

/// Prints a result to stdout. A reader that has gone away, as in `pathspace ... | head`, is no error.
pub fn print_result(text: &str) -> anyhow::Result<()> {
    let mut stdout = std::io::stdout().lock();
    match writeln!(stdout, "{}", text.trim_end_matches('\n')).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error).context("cannot write to stdout"),
        _ => Ok(()),
    }
}

/// Same directory, so that the rename stays within one file system; with the permissions that a newly created file has.
fn temporary_beside(path: &Path) -> anyhow::Result<NamedTempFile> {
    if path.is_dir() {
        bail!("it is a directory");
    }
    let directory = match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder
        .prefix(".pathspace-")
        .tempfile_in(directory)
        .map_err(|error| error.kind())
        .map_err(|kind| anyhow::anyhow!("the directory '{}' takes no new file: {kind}", directory.display()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::display::Image;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.txt");
        write_atomically(&path, |file| file.write_all(b"old")).unwrap();
        let failed = write_atomically(&path, |file| {
            file.write_all(b"ne")?;
            Err(std::io::Error::other("interrupted"))
        });
        assert!(format!("{:#}", failed.unwrap_err()).contains("interrupted"));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 1);
    }

    #[test]
    fn pictures_are_written_by_their_extension_and_finite() {
        let directory = tempfile::tempdir().unwrap();
        let image = Image::new(2, 1, vec![[0.5; 3], [f32::NAN; 3]]);
        let contents = ExrContents { image: &image, beside: &[], attributes: &[] };
        for name in ["a.exr", "a.PNG"] {
            let path = directory.path().join(name);
            write_picture(&path, &contents, &ToneMapping::default()).unwrap();
            assert_eq!(Image::read(&path).unwrap().pixels[1], [0.0; 3]);
        }
    }

    #[test]
    fn checking_writability_touches_nothing() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.png");
        check_writable([path.as_path()]).unwrap();
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0);
        assert!(check_writable([path.as_path(), path.as_path()]).is_err());
        assert!(check_writable([directory.path()]).is_err());
        assert!(check_writable([directory.path().join("missing/a.png").as_path()]).is_err());
    }
}
