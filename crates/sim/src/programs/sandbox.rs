//! Walls around a program, as far as the system offers them without privileges: bubblewrap (`bwrap`), which runs it in
//! namespaces of its own. It sees the system's programs and libraries and its own folder, all of them read-only, and
//! neither a network nor other processes. Nothing is writable, so that it cannot fill the memory with files either.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

const BUBBLEWRAP: &str = "bwrap";

/// Folders of the system's programs, libraries and settings, as far as they exist.
const SYSTEM: [&str; 9] = ["/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/etc", "/opt", "/nix"];

/// Says that programs run without walls, if that is so: bubblewrap is not there, or must not make namespaces.
pub fn missing_note() -> Option<&'static str> {
    let note = "bubblewrap (bwrap) does not work here, so programs run without a sandbox: they have limits of time, memory \
                and processes, but can read the files of this user and use the network";
    (!is_available()).then_some(note)
}

/// Tried once, as containers often have the program and not the permission.
fn is_available() -> bool {
    static AVAILABLE: OnceLock<bool> = OnceLock::new();
    *AVAILABLE.get_or_init(|| {
        let tried = Command::new(BUBBLEWRAP)
            .args(walls(Path::new("/usr"), Path::new("true")))
            .arg("true")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
        tried.is_ok_and(|status| status.success())
    })
}

/// Returns the command that runs a command in a folder behind walls; the command itself where there are none.
pub fn sandboxed(folder: &Path, command: &[OsString]) -> Vec<OsString> {
    let Some(program) = command.first().filter(|_| is_available()) else { return command.to_vec() };
    let walls = walls(&fs::canonicalize(folder).unwrap_or(folder.to_owned()), Path::new(program));
    [BUBBLEWRAP.into()].into_iter().chain(walls).chain(command.iter().cloned()).collect()
}

fn walls(folder: &Path, program: &Path) -> Vec<OsString> {
    let mut walls: Vec<OsString> =
        ["--unshare-all", "--die-with-parent", "--new-session", "--clearenv"].map(Into::into).into();
    // Only what leads to interpreters is passed on: other variables may hold secrets.
    let variables = ["PATH", "VIRTUAL_ENV"].map(|name| (name, env::var_os(name)));
    for (name, value) in variables.into_iter().chain([("HOME", Some("/".into())), ("LANG", Some("C.UTF-8".into()))]) {
        walls.extend(value.into_iter().flat_map(|value| ["--setenv".into(), name.into(), value]));
    }
    // A prefix that holds the folder would show all that lies beside it.
    let installed = installation_of(program).into_iter().filter(|prefix| !folder.starts_with(prefix));
    for visible in SYSTEM.map(PathBuf::from).into_iter().chain(installed) {
        walls.extend(["--ro-bind-try".into(), visible.clone().into(), visible.into()]);
    }
    // The folder last: it may lie below one of the others.
    walls.extend(["--ro-bind".into(), folder.into(), folder.into(), "--chdir".into(), folder.into()]);
    // Read-only last, when all is mounted.
    walls.extend(["--proc", "/proc", "--dev", "/dev", "--remount-ro", "/dev", "--remount-ro", "/"].map(Into::into));
    walls
}

/// Finds where an interpreter outside of the system's folders is installed, such as one in a user's folder: the folder above
/// the `bin` that holds it, also of the file that it links to, as in virtual environments.
fn installation_of(program: &Path) -> Vec<PathBuf> {
    let path = env::var_os("PATH").unwrap_or_default();
    let Some(found) = env::split_paths(&path).map(|folder| folder.join(program)).find(|file| file.is_file()) else {
        return Vec::new();
    };
    let links = [Some(found.clone()), fs::canonicalize(found).ok()];
    let prefixes = links.into_iter().flatten().filter_map(|file| {
        let bin = file.parent()?;
        bin.ends_with("bin").then(|| bin.parent().map(Path::to_owned))?
    });
    prefixes
        .filter(|prefix| !SYSTEM.iter().any(|folder| prefix.starts_with(folder)) && prefix != Path::new("/"))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where there are no walls, nothing is promised.
    #[test]
    fn program_behind_walls_sees_only_its_folder_and_writes_nowhere() {
        let course = tempfile::tempdir().expect("writable");
        let folder = course.path().join("entry");
        fs::create_dir(&folder).expect("writable");
        fs::write(course.path().join("secret.csv"), "7\n").expect("writable");
        fs::write(folder.join("data.txt"), "data\n").expect("writable");
        let script = "cat data.txt; cat ../secret.csv; echo x > data.txt; echo x > /tmp/x; echo x > /dev/shm/x; ls /proc | grep -c '^[0-9]'";
        let command = ["sh", "-c", script].map(OsString::from);
        let walled = sandboxed(&folder, &command);
        if missing_note().is_some() {
            assert_eq!(walled, command);
            return;
        }
        let output = Command::new(&walled[0]).args(&walled[1..]).output().expect("it starts");
        let stdout = String::from_utf8_lossy(&output.stdout);
        let lines: Vec<&str> = stdout.lines().collect();
        assert_eq!(lines[0], "data", "{output:?}");
        assert!(lines[1].parse::<u32>().is_ok_and(|processes| processes < 10), "{output:?}");
        assert_eq!(lines.len(), 2, "{output:?}");
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(stderr.matches("Read-only file system").count(), 3, "{stderr}");
    }
}
