//! Writing several files so that a reader finds all of the old ones or all of the new ones, never half a file.

use crate::diag::Diagnostic;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A file to be written.
pub struct NewFile<'a> {
    /// Its final name.
    pub path: PathBuf,
    /// Its content.
    pub content: &'a [u8],
}

/// Links that a name may lead through, as Linux follows.
const MAX_LINKS: usize = 40;

/// Writes all files, or none; where a name is a symbolic link, the file that it leads to. Each goes to a temporary name in its
/// folder, is flushed and synced, and only when all are complete they are renamed. Where a rename fails, those before it are
/// undone.
///
/// # Errors
/// One diagnostic with the path and the reason of the system.
pub fn write_all(files: &[NewFile]) -> Result<(), Diagnostic> {
    let files: Vec<NewFile> = files.iter().map(|f| NewFile { path: target(&f.path), content: f.content }).collect();
    // A rename would put a file in the place of a device or pipe. (Of folders it fails.)
    let is_special = |path: &Path| fs::metadata(path).is_ok_and(|m| !m.is_file() && !m.is_dir());
    if let Some(file) = files.iter().find(|f| is_special(&f.path)) {
        return Err(refused(&file.path, &io::Error::other("it is no regular file")));
    }
    let temporary: Vec<PathBuf> = files.iter().map(|f| beside(&f.path, "new")).collect();
    let discard = || temporary.iter().for_each(|t| drop(fs::remove_file(t)));
    for (file, temporary) in files.iter().zip(&temporary) {
        if let Err(e) = write_synced(temporary, file.content) {
            discard();
            return Err(refused(&file.path, &e));
        }
    }
    let backups: Vec<PathBuf> = files.iter().map(|f| beside(&f.path, "old")).collect();
    for (file, backup) in files.iter().zip(&backups) {
        // No backup where there is no old file, or no hard links: then a failed rename cannot be undone.
        drop(fs::hard_link(&file.path, backup));
    }
    let mut outcome = Ok(());
    for (k, file) in files.iter().enumerate() {
        if let Err(e) = fs::rename(&temporary[k], &file.path) {
            for (done, backup) in files[..k].iter().zip(&backups) {
                if fs::rename(backup, &done.path).is_err() {
                    drop(fs::remove_file(&done.path));
                }
            }
            discard();
            outcome = Err(refused(&file.path, &e));
            break;
        }
    }
    backups.iter().for_each(|b| drop(fs::remove_file(b)));
    for file in &files {
        // The rename itself reaches the disk with its folder; not every system can sync a folder.
        drop(File::open(folder_of(&file.path)).and_then(|d| d.sync_all()));
    }
    outcome
}

/// Where a name leads through symbolic links, there or not: renaming onto a link would replace the link.
fn target(path: &Path) -> PathBuf {
    let onward = |at: &PathBuf| fs::read_link(at).ok().map(|next| folder_of(at).join(next));
    let chain = std::iter::successors(Some(path.to_owned()), onward);
    chain.take(MAX_LINKS + 1).last().unwrap_or_else(|| path.to_owned())
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// A hidden name in the same folder, own to this process.
fn beside(path: &Path, what: &str) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    folder_of(path).join(format!(".{name}.{}.{what}", std::process::id()))
}

fn write_synced(path: &Path, content: &[u8]) -> io::Result<()> {
    let mut file = File::create(path)?;
    file.write_all(content)?;
    file.flush()?;
    file.sync_all()
}

fn refused(path: &Path, error: &io::Error) -> Diagnostic {
    Diagnostic::error("cannot-write", format!("cannot write {}: {error}", path.display()))
        .hint("nothing was changed; choose another place with -o, or make the folder writable")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_files_or_none() {
        let folder = std::env::temp_dir().join(format!("gsm-atomic-{}", std::process::id()));
        fs::create_dir_all(folder.join("taken/inside")).unwrap();
        fs::write(folder.join("a"), "old").unwrap();
        let file = |name: &str| NewFile { path: folder.join(name), content: b"new" };
        // A folder that is not empty cannot be replaced by a file.
        let fault = write_all(&[file("a"), file("taken")]).unwrap_err();
        assert!(fault.message.contains("taken"), "{fault:?}");
        assert_eq!(fs::read(folder.join("a")).unwrap(), b"old");
        assert!(write_all(&[file("a"), file("missing/b")]).is_err());
        assert_eq!(fs::read(folder.join("a")).unwrap(), b"old");
        assert!(write_all(&[file("a"), file("b")]).is_ok());
        assert_eq!(fs::read(folder.join("a")).unwrap(), b"new");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 3);
        fs::remove_dir_all(&folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn links_stay_and_their_targets_are_written() {
        let folder = std::env::temp_dir().join(format!("gsm-links-{}", std::process::id()));
        fs::create_dir_all(folder.join("deep")).unwrap();
        fs::write(folder.join("deep/a"), "old").unwrap();
        // Two links in a row, and one to a file that is not there yet.
        for (to, name) in [("deep/a", "b"), ("b", "c"), ("deep/new", "d")] {
            std::os::unix::fs::symlink(to, folder.join(name)).unwrap();
        }
        let file = |name: &str| NewFile { path: folder.join(name), content: b"new" };
        write_all(&[file("c"), file("d")]).unwrap();
        assert!(["b", "c", "d"].iter().all(|name| fs::symlink_metadata(folder.join(name)).unwrap().is_symlink()));
        assert!(["deep/a", "deep/new"].iter().all(|name| fs::read(folder.join(name)).unwrap() == b"new"));
        std::os::unix::fs::symlink("/dev/null", folder.join("e")).unwrap();
        assert!(write_all(&[file("e")]).unwrap_err().message.contains("no regular file"));
        fs::remove_file(folder.join("e")).unwrap();
        assert_eq!((fs::read_dir(&folder).unwrap().count(), fs::read_dir(folder.join("deep")).unwrap().count()), (4, 2));
        fs::remove_dir_all(&folder).unwrap();
    }
}
