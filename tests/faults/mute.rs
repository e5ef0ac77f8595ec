use std::net::SocketAddr;

use tokio::net::TcpListener;

/// A server that takes connections and says nothing on them, for as long as the runtime lives. Gives where it is.
pub(crate) async fn mute() -> String {
    let listener = TcpListener::bind(SocketAddr::from(([127, 0, 0, 1], 0))).await.unwrap();
    let address = listener.local_addr().unwrap();
    tokio::spawn(async move {
        let mut held = Vec::new();
        while let Ok((axis, _)) = listener.accept().await {
            held.push(axis);
        }
    });
    format!("http://{address}")
}
