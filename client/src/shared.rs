//! Connections that several streams share.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use tokio::sync::OnceCell;
use tonic::transport::Channel;

use crate::Error;

/// The connections to servers that are shared, by endpoint.
#[derive(Debug)]
pub(crate) struct Shared {
    /// How many share one.
    most: usize,
    connections: Mutex<HashMap<String, Vec<Arc<Connection>>>>,
}

/// One of them, or what will be one.
#[derive(Debug, Default)]
struct Connection {
    channel: OnceCell<Result<Channel, Error>>,
    /// Takes nobody new: something that was asked over it was never answered.
    is_retired: AtomicBool,
}

/// A place on a connection, for as long as it or a clone of it is kept.
#[derive(Clone, Debug)]
pub(crate) struct Place(Arc<Seat>);

#[derive(Debug)]
struct Seat(Arc<Connection>);

/// A place on a connection that is retired unless it is proved.
#[derive(Debug)]
pub(crate) struct Trial(Option<Place>);

impl Shared {
    pub(crate) fn by(most: usize) -> Self {
        Self { most: most.max(1), connections: Mutex::default() }
    }

    /// A place on the first connection to `endpoint` that has one.
    pub(crate) fn place(&self, endpoint: &str) -> Place {
        let mut connections = self.connections.lock().unwrap_or_else(PoisonError::into_inner);
        let there = connections.entry(endpoint.into()).or_default();
        // Those who are on a retired one keep it; here it is not needed any more.
        there.retain(|connection| !connection.is_retired());
        // One reference is this list's, each other one is a place.
        if let Some(connection) = there.iter().find(|it| Arc::strong_count(it) <= self.most) {
            return Place::on(connection);
        }
        let connection = Arc::<Connection>::default();
        let place = Place::on(&connection);
        there.push(connection);
        place
    }

    /// The same rule, and no connections yet.
    pub(crate) fn anew(&self) -> Self {
        Self::by(self.most)
    }
}

impl Connection {
    fn is_retired(&self) -> bool {
        self.is_retired.load(Ordering::Relaxed)
    }
}

impl Place {
    fn on(connection: &Arc<Connection>) -> Self {
        Self(Arc::new(Seat(Arc::clone(connection))))
    }

    /// The connection, which the first who asks makes. Where that fails, it has failed for all who waited with him, and the next
    /// place is on another.
    pub(crate) async fn channel<F>(&self, connect: impl FnOnce() -> F) -> Result<Channel, Error>
    where
        F: Future<Output = Result<Channel, Error>>,
    {
        let connected = self.0.0.channel.get_or_init(connect).await;
        if connected.is_err() {
            self.retire();
        }
        connected.clone()
    }

    fn retire(&self) {
        self.0.0.is_retired.store(true, Ordering::Relaxed);
    }
}

impl Trial {
    pub(crate) fn of(place: Option<Place>) -> Self {
        Self(place)
    }

    /// Somebody answers at the other end.
    pub(crate) fn proved(mut self) {
        self.0 = None;
    }
}

impl Drop for Trial {
    fn drop(&mut self) {
        if let Some(place) = &self.0 {
            place.retire();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Which of the places are on one connection.
    fn same(a: &Place, b: &Place) -> bool {
        Arc::ptr_eq(&a.0.0, &b.0.0)
    }

    #[test]
    fn a_connection_takes_as_many_as_it_has_places_and_gets_them_back() {
        let shared = Shared::by(2);
        let (first, second, third) = (shared.place("a"), shared.place("a"), shared.place("a"));
        assert!(same(&first, &second) && !same(&first, &third));
        assert!(!same(&first, &shared.place("b")), "another server is another connection");
        drop(second);
        assert!(same(&first, &shared.place("a")), "a place that is given back");
    }

    #[test]
    fn what_is_not_answered_retires_the_connection_for_those_who_come() {
        let shared = Shared::by(10);
        let first = shared.place("a");
        Trial::of(Some(first.clone())).proved();
        assert!(same(&first, &shared.place("a")));
        drop(Trial::of(Some(first.clone())));
        assert!(!same(&first, &shared.place("a")));
    }

    #[tokio::test]
    async fn one_connects_for_all_and_a_failure_is_told_to_all() {
        let shared = Shared::by(10);
        let (first, second) = (shared.place("a"), shared.place("a"));
        let fails = || Error::Unreachable { endpoint: "a".into(), cause: "gone".into() };
        let told = first.channel(|| async { Err(fails()) }).await.unwrap_err();
        assert_eq!(told, fails());
        let told = second.channel(|| async { panic!("it was asked already") }).await.unwrap_err();
        assert_eq!(told, fails());
        assert!(!same(&first, &shared.place("a")), "the next one tries again");
    }
}
