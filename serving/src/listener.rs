//! What a process listens with: a port, or a Unix socket that is there as long as the process is.

use std::ffi::OsString;
use std::io;
use std::os::unix::fs::{FileTypeExt as _, MetadataExt as _, PermissionsExt as _};
use std::path::{Path, PathBuf};
use std::pin::Pin;
use std::task::{Context, Poll};

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream, UnixListener, UnixStream};
use tonic::transport::server::{Connected, TcpConnectInfo};

use crate::address::Address;

/// Takes connections.
#[derive(Debug)]
pub(crate) enum Listener {
    Tcp(TcpListener),
    Unix(UnixListener, Place),
}

/// The file of a socket, which goes with its value.
#[derive(Debug)]
pub(crate) struct Place {
    path: PathBuf,
    /// Device and number: another process may have put its own there since.
    file: (u64, u64),
}

/// Who may connect to a Unix socket: its owner and his group.
const MODE: u32 = 0o660;

impl Listener {
    /// Takes the address. A socket that nobody listens at any more is replaced; any other file is left alone.
    pub(crate) async fn at(address: &Address) -> io::Result<Self> {
        match address {
            Address::Tcp(address) => TcpListener::bind(address).await.map(Self::Tcp),
            Address::Unix(path) => {
                is_free(path)?;
                // Under another name until it has its mode: nobody is to connect before.
                let mut new = OsString::from(path);
                new.push(".new");
                let new = PathBuf::from(new);
                if new.symlink_metadata().is_ok_and(|metadata| metadata.file_type().is_socket()) {
                    std::fs::remove_file(&new)?;
                }
                let listener = UnixListener::bind(&new)?;
                let metadata = new.symlink_metadata()?;
                let place = Place { path: path.clone(), file: (metadata.dev(), metadata.ino()) };
                std::fs::set_permissions(&new, std::fs::Permissions::from_mode(MODE))?;
                std::fs::rename(&new, path)?;
                Ok(Self::Unix(listener, place))
            }
        }
    }

    /// Where it listens, with the port that it got.
    pub(crate) fn address(&self) -> io::Result<Address> {
        match self {
            Self::Tcp(listener) => listener.local_addr().map(Address::Tcp),
            Self::Unix(_, place) => Ok(Address::Unix(place.path.clone())),
        }
    }

    pub(crate) fn poll_accept(&self, cx: &mut Context<'_>) -> Poll<io::Result<Socket>> {
        match self {
            Self::Tcp(listener) => {
                listener.poll_accept(cx).map(|accepted| accepted.map(|(socket, _)| Socket::Tcp(socket)))
            }
            Self::Unix(listener, _) => {
                listener.poll_accept(cx).map(|accepted| accepted.map(|(socket, _)| Socket::Unix(socket)))
            }
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let there = self.path.symlink_metadata().map(|metadata| (metadata.dev(), metadata.ino()));
        if there.is_ok_and(|file| file == self.file) {
            // Where it cannot be removed, whoever listens there next replaces it.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// Is nothing at `path`, or a socket that nobody listens at?
fn is_free(path: &Path) -> io::Result<()> {
    let taken = |what: &str| Err(io::Error::new(io::ErrorKind::AddrInUse, what));
    match path.symlink_metadata() {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(error) => Err(error),
        Ok(metadata) if !metadata.file_type().is_socket() => taken("a file that is no socket is there"),
        Ok(_) => match std::os::unix::net::UnixStream::connect(path) {
            Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => Ok(()),
            Err(error) => Err(error),
            Ok(_) => taken("another process listens there"),
        },
    }
}

/// One connection.
#[derive(Debug)]
pub(crate) enum Socket {
    Tcp(TcpStream),
    Unix(UnixStream),
}

impl Socket {
    /// A setpoint is not to wait for the next one; a Unix socket waits for nothing.
    pub(crate) fn set_nodelay(&self) -> io::Result<()> {
        match self {
            Self::Tcp(socket) => socket.set_nodelay(true),
            Self::Unix(_) => Ok(()),
        }
    }
}

/// The same of either kind.
macro_rules! of_either {
    ($self:ident, $socket:ident => $does:expr) => {
        match $self.get_mut() {
            Socket::Tcp($socket) => $does,
            Socket::Unix($socket) => $does,
        }
    };
}

impl AsyncRead for Socket {
    fn poll_read(
        self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        of_either!(self, socket => Pin::new(socket).poll_read(cx, buffer))
    }
}

impl AsyncWrite for Socket {
    fn poll_write(self: Pin<&mut Self>, cx: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        of_either!(self, socket => Pin::new(socket).poll_write(cx, bytes))
    }

    fn poll_flush(self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        of_either!(self, socket => Pin::new(socket).poll_flush(cx))
    }

    fn poll_shutdown(self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        of_either!(self, socket => Pin::new(socket).poll_shutdown(cx))
    }

    fn poll_write_vectored(
        self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        pieces: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        of_either!(self, socket => Pin::new(socket).poll_write_vectored(cx, pieces))
    }

    fn is_write_vectored(&self) -> bool {
        // Either kind writes several pieces at once.
        true
    }
}

impl Connected for Socket {
    type ConnectInfo = TcpConnectInfo;

    /// Whoever comes by a Unix socket has no address.
    fn connect_info(&self) -> TcpConnectInfo {
        match self {
            Self::Tcp(socket) => socket.connect_info(),
            Self::Unix(_) => TcpConnectInfo { local_addr: None, remote_addr: None },
        }
    }
}
