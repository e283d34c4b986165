//! Scenes in memory, by id.
//!
//! Every change makes a new [`Entry`]; one that fails leaves the old one as it was. The lock covers
//! looking entries up and putting them in, never a compilation, so that readers do not wait for a
//! large upload. Two changes at once both take effect: the one that comes second finds that the
//! entry it started from is gone, and is made again on top of the new one.
//!
//! Each scene is a channel whose value is its version now; who watches it hears of the next one, and of
//! its end.

mod entry;

pub use entry::{Entry, NewScene, Precondition};

use super::{Document, Files, SceneError, compile};
use crate::limits::Limits;
use bytes::Bytes;
use entry::{Draft, whole_fault};
use serde_json::Value;
use std::collections::BTreeMap;
use std::hash::{BuildHasher, RandomState};
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};
use std::time::SystemTime;
use tokio::sync::watch;

/// Why the store did not do as asked. Nothing has changed then.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StoreError {
    /// No such scene or file (404).
    #[error("there is no such scene or file")]
    NotFound,
    /// A [`Precondition`] does not hold (412).
    #[error("the scene is not in a version that If-Match or If-None-Match allows")]
    PreconditionFailed,
    /// All scenes together would take too much memory (507).
    #[error("all scenes together would take {value} bytes of {limit} (RASTERD_MAX_TOTAL_BYTES)")]
    Full {
        /// Bytes they may take.
        limit: u64,
        /// Bytes they would take.
        value: u64,
    },
    /// It makes no scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

/// Scenes by id.
type Entries = BTreeMap<String, watch::Sender<Entry>>;

/// All scenes.
#[derive(Debug)]
pub struct Store {
    limits: Limits,
    entries: RwLock<Entries>,
    /// Random per store: ids can't be guessed, and versions of one run are not those of another.
    random: RandomState,
}

impl Store {
    /// An empty store.
    #[must_use]
    pub fn new(limits: Limits) -> Self {
        Self { limits, entries: RwLock::default(), random: RandomState::new() }
    }

    /// The scene `id` as it is now.
    #[must_use]
    pub fn get(&self, id: &str) -> Option<Entry> {
        now(&self.read(), id)
    }

    /// The versions of the scene `id` from now on: the channel closes when it is removed. A scene that
    /// gets the same id later has another one.
    #[must_use]
    pub fn watch(&self, id: &str) -> Option<watch::Receiver<Entry>> {
        self.read().get(id).map(watch::Sender::subscribe)
    }

    /// All scenes in order of id.
    #[must_use]
    pub fn list(&self) -> Vec<Entry> {
        self.read().values().map(|versions| versions.borrow().clone()).collect()
    }

    /// Keeps `new` under an id of its own.
    ///
    /// # Errors
    /// [`StoreError::Scene`] and [`StoreError::Full`].
    pub fn create(&self, new: NewScene) -> Result<Entry, StoreError> {
        let files = new.files_over(None);
        let (document, compiled) = new.build(&files, None, &self.limits)?;
        let draft = Draft::of(&document, compiled, files);
        let mut entries = self.write();
        let id = self.unused_id(&entries);
        self.insert(&mut entries, &id, draft)
    }

    /// Keeps `new` under `id`, in place of what is there. Also says whether nothing was. Files stay
    /// where `new` brings none of its own, so that what a client reads can be put back.
    ///
    /// # Errors
    /// [`StoreError`] but [`StoreError::NotFound`]; an id that is none is a document's fault.
    pub fn put(
        &self,
        id: &str,
        new: NewScene,
        precondition: &Precondition,
    ) -> Result<(Entry, bool), StoreError> {
        if !is_id(id) {
            return Err(whole_fault("a scene's id must match [A-Za-z0-9_-]{1,64}".to_owned()).into());
        }
        loop {
            let before = self.get(id);
            precondition.check(before.as_ref())?;
            let files = new.files_over(before.as_ref());
            let assets = before.as_ref().map(|entry| &*entry.assets);
            let (document, compiled) = new.build(&files, assets, &self.limits)?;
            let draft = Draft::of(&document, compiled, files);
            let mut entries = self.write();
            let now = now(&entries, id);
            // What is replaced does not matter to the new scene but for files that stay; it does to
            // the precondition.
            precondition.check(now.as_ref())?;
            if new.files.is_none() && !same_files(before.as_ref(), now.as_ref()) {
                continue;
            }
            let is_new = now.is_none();
            return Ok((self.insert(&mut entries, id, draft)?, is_new));
        }
    }

    /// Applies a merge patch (RFC 7396) to the scene's document: all of it or nothing.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn patch(&self, id: &str, patch: &Value, precondition: &Precondition) -> Result<Entry, StoreError> {
        self.change(id, precondition, |entry| {
            let (document, compiled) = entry.build_patched(patch, &self.limits)?;
            Ok(Draft::of(&document, compiled, entry.files.clone()))
        })
    }

    /// Adds or replaces a file; what refers to it changes with it.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn put_file(
        &self,
        id: &str,
        name: &str,
        bytes: Bytes,
        precondition: &Precondition,
    ) -> Result<Entry, StoreError> {
        self.change_files(id, precondition, |files| {
            files.insert(name, bytes.clone()).map_err(|detail| whole_fault(detail).into())
        })
    }

    /// Removes a file. A document that refers to it as texture or mesh keeps it from being removed.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn delete_file(
        &self,
        id: &str,
        name: &str,
        precondition: &Precondition,
    ) -> Result<Entry, StoreError> {
        self.change_files(id, precondition, |files| files.remove(name).map(drop).ok_or(StoreError::NotFound))
    }

    /// Removes a scene.
    ///
    /// # Errors
    /// [`StoreError::NotFound`] and [`StoreError::PreconditionFailed`].
    pub fn delete(&self, id: &str, precondition: &Precondition) -> Result<(), StoreError> {
        let mut entries = self.write();
        let entry = now(&entries, id).ok_or(StoreError::NotFound)?;
        precondition.check(Some(&entry))?;
        entries.remove(id);
        Ok(())
    }

    fn change_files(
        &self,
        id: &str,
        precondition: &Precondition,
        edit: impl Fn(&mut Files) -> Result<(), StoreError>,
    ) -> Result<Entry, StoreError> {
        self.change(id, precondition, |entry| {
            let mut files = Files::clone(&entry.files);
            edit(&mut files)?;
            let document = Document::from_json(&entry.document).map_err(SceneError::Document)?;
            let compiled = compile(&document, &files, Some(&entry.assets), &self.limits)?;
            Ok(Draft::of(&document, compiled, Arc::new(files)))
        })
    }

    /// Makes a new version of `id` from the current one, again and again until no other change has
    /// come between.
    fn change(
        &self,
        id: &str,
        precondition: &Precondition,
        make: impl Fn(&Entry) -> Result<Draft, StoreError>,
    ) -> Result<Entry, StoreError> {
        loop {
            let before = self.get(id).ok_or(StoreError::NotFound)?;
            precondition.check(Some(&before))?;
            let draft = make(&before)?;
            let mut entries = self.write();
            if now(&entries, id).is_some_and(|now| now.is_version(&before)) {
                return self.insert(&mut entries, id, draft);
            }
        }
    }

    fn insert(&self, entries: &mut Entries, id: &str, draft: Draft) -> Result<Entry, StoreError> {
        let others = entries.iter().filter(|(other, _)| *other != id);
        let others: u64 = others.map(|(_, versions)| versions.borrow().bytes).sum();
        let (limit, value) = (self.limits.total_bytes, others.saturating_add(draft.bytes));
        if value > limit {
            return Err(StoreError::Full { limit, value });
        }
        let before = now(entries, id);
        let before = before.as_ref();
        let created = before.map_or_else(SystemTime::now, |entry| entry.created);
        let incarnation =
            before.map_or_else(|| self.random.hash_one((id, created)), |entry| entry.incarnation);
        let revision = before.map_or(1, |entry| entry.revision + 1);
        let entry = Entry {
            id: id.to_owned(),
            revision,
            scene: Arc::new(draft.scene),
            document: Arc::new(draft.document),
            files: draft.files,
            etag: format!("\"{incarnation:016x}-{revision}\""),
            bytes: draft.bytes,
            created,
            assets: Arc::new(draft.assets),
            incarnation,
        };
        match entries.get(id) {
            Some(versions) => drop(versions.send_replace(entry.clone())),
            None => drop(entries.insert(id.to_owned(), watch::Sender::new(entry.clone()))),
        }
        Ok(entry)
    }

    fn unused_id(&self, entries: &Entries) -> String {
        let candidates = (0_u64..)
            .map(|n| format!("{:016x}", self.random.hash_one((entries.len(), SystemTime::now(), n))));
        let mut unused = candidates.filter(|id| !entries.contains_key(id));
        unused.next().expect("invariant: fewer scenes than ids")
    }

    // A panic while the lock is held leaves the map whole: every change of it is one insertion or
    // removal. So a poisoned lock is as good as any.
    fn read(&self) -> RwLockReadGuard<'_, Entries> {
        self.entries.read().unwrap_or_else(PoisonError::into_inner)
    }

    fn write(&self) -> RwLockWriteGuard<'_, Entries> {
        self.entries.write().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The version of `id` that is there now.
fn now(entries: &Entries, id: &str) -> Option<Entry> {
    entries.get(id).map(|versions| versions.borrow().clone())
}

/// Whether two versions of a scene, or none, have the same files.
fn same_files(a: Option<&Entry>, b: Option<&Entry>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => Arc::ptr_eq(&a.files, &b.files),
        (None, None) => true,
        _ => false,
    }
}

/// Whether `id` matches `[A-Za-z0-9_-]{1,64}`.
#[must_use]
pub fn is_id(id: &str) -> bool {
    (1..=64).contains(&id.len()) && id.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'-')
}
