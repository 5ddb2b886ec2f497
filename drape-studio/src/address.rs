//! The address of a studio, kept beside its session so that a page that was left open finds it again.

use std::fs;
use std::io::Write as _;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use serde::{Deserialize, Serialize};

use crate::server::Guard;

/// What a page needs to come back: whoever knows it may use the studio, so only its user may read the file.
#[derive(Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Address {
    port: u16,
    token: String,
}

/// Takes a port on this computer that others cannot reach: `port`, or where that is 0 the one that the session had, or a
/// free one. The token is the one that the session had, else a new one.
pub(crate) fn listen(session: &Path, port: u16) -> Result<(TcpListener, Guard)> {
    let path = path_beside(session);
    let kept = read(&path);
    let known_port = kept.as_ref().map(|kept| kept.port).filter(|_| port == 0);
    let listener = known_port
        .and_then(|port| bind(port).ok())
        .map_or_else(|| bind(port), Ok)
        .with_context(|| format!("port {port} cannot be opened"))?;
    let address = listener.local_addr()?;
    let guard = match kept {
        Some(kept) => Guard::with_token(address, kept.token),
        None => Guard::new(address)?,
    };
    let now = Address {
        port: address.port(),
        token: guard.token().to_owned(),
    };
    write(&path, &now).with_context(|| format!("{}: cannot be written", path.display()))?;
    Ok((listener, guard))
}

fn bind(port: u16) -> std::io::Result<TcpListener> {
    TcpListener::bind(SocketAddr::from((Ipv4Addr::LOCALHOST, port)))
}

fn path_beside(session: &Path) -> PathBuf {
    session.with_extension("address")
}

/// What [`write`] wrote; nothing where the file is another.
fn read(path: &Path) -> Option<Address> {
    let kept: Address = serde_json::from_slice(&fs::read(path).ok()?).ok()?;
    let is_token = kept.token.len() == 32 && kept.token.bytes().all(|b| b.is_ascii_hexdigit());
    is_token.then_some(kept)
}

/// A file that only its owner reads, whatever the folder allows.
fn write(path: &Path, address: &Address) -> Result<()> {
    // Made anew: the rights of a file that is there stay as they are when it is written.
    drop(fs::remove_file(path));
    let mut options = fs::OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    Ok(options
        .open(path)?
        .write_all(&serde_json::to_vec(address)?)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_taken_up_again() {
        let folder = tempfile::tempdir().unwrap();
        let session = folder.path().join("a.json");
        let (listener, guard) = listen(&session, 0).unwrap();
        let port = listener.local_addr().unwrap().port();
        drop(listener);
        let (again, same) = listen(&session, 0).unwrap();
        assert_eq!(again.local_addr().unwrap().port(), port);
        assert_eq!(same.token(), guard.token());
        // While it is taken, another port is, with the same token.
        let (other, same) = listen(&session, 0).unwrap();
        assert_ne!(other.local_addr().unwrap().port(), port);
        assert_eq!(same.token(), guard.token());
    }

    #[test]
    fn a_file_that_is_no_address_gives_none() {
        let folder = tempfile::tempdir().unwrap();
        let session = folder.path().join("a.json");
        for text in ["", "{}", r#"{"port":1,"token":"../../x"}"#] {
            fs::write(path_beside(&session), text).unwrap();
            let (_, guard) = listen(&session, 0).unwrap();
            assert_eq!(guard.token().len(), 32, "{text}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn nobody_else_reads_it() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let session = folder.path().join("a.json");
        drop(listen(&session, 0).unwrap());
        let rights = fs::metadata(path_beside(&session)).unwrap().permissions();
        assert_eq!(rights.mode() & 0o777, 0o600);
    }
}
