//! Backgrounds: their pictures, and computed skies.

use super::Loader;
use super::build;
use super::cache::{SkyAsset, same_bytes};
use crate::model::sky::{CubeMap, Daylight, FaceFault, Panorama, Picture, PictureSize};
use crate::scene::compile::SceneError;
use crate::scene::document::{BackgroundPart, FACES};
use crate::scene::{Background, Fault};
use bytes::Bytes;
use glam::DVec3;
use std::sync::Arc;

/// Which background of a document it is.
pub(in crate::scene) struct BackgroundPlace {
    /// Its JSON pointer.
    pub pointer: String,
    /// What to call it.
    pub what: String,
}

/// A file with the name it is stored under.
type File = (String, Bytes);

impl Loader<'_> {
    /// A background of the document; `towards_sun` is where a procedural sky has its sun. One whose
    /// pictures are not all there is the default gradient, with a warning.
    pub(in crate::scene) fn background(
        &mut self,
        part: &BackgroundPart,
        place: &BackgroundPlace,
        towards_sun: DVec3,
    ) -> Result<Background, SceneError> {
        let loaded = match part {
            BackgroundPart::Color(color) => Some(Background::Color(color.to_linear())),
            BackgroundPart::Gradient { top, bottom } => {
                Some(Background::Gradient { top: top.to_linear(), bottom: bottom.to_linear() })
            }
            BackgroundPart::Transparent => Some(Background::Transparent),
            BackgroundPart::Sky { turbidity, .. } => {
                let key = format!("sky {towards_sun:?} {turbidity:?}");
                let make = |_, _: &[File], _: &Self| {
                    Ok(Background::Sky(Arc::new(Daylight::new(towards_sun, *turbidity))))
                };
                Some(self.sky(key, Vec::new(), make)?)
            }
            BackgroundPart::Equirect { file } => match self.find_picture(file, &place.what) {
                Some(file) => Some(self.sky(format!("equirect {}", file.0), vec![file], panorama)?),
                None => None,
            },
            BackgroundPart::Cubemap { faces } => match self.find_faces(faces, place) {
                Some(files) => {
                    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
                    let key = format!("cubemap {names:?}");
                    let make = |key, files: &[File], loader: &Self| cube_map(key, files, loader, place);
                    Some(self.sky(key, files, make)?)
                }
                None => None,
            },
        };
        match loaded {
            Some(background) => Ok(background),
            None => self.background(&BackgroundPart::default(), place, towards_sun),
        }
    }

    /// The files of all six faces; a warning for each that is missing.
    fn find_faces(&mut self, faces: &[String; 6], place: &BackgroundPlace) -> Option<Vec<File>> {
        let found: Vec<_> = faces.iter().map(|file| self.find_picture(file, &place.what)).collect();
        found.into_iter().collect()
    }

    /// What `make` makes of `files`, or the same as it was made before. A key stands for all that it is
    /// made of but the bytes of its files. What may be large is refused by `make` itself, by
    /// [`Loader::check_room`], before it is there.
    fn sky(
        &mut self,
        key: String,
        files: Vec<File>,
        make: impl FnOnce(String, &[File], &Self) -> Result<Background, SceneError>,
    ) -> Result<Background, SceneError> {
        if let Some(asset) = self.assets.skies.get(&key) {
            return Ok(asset.background.clone());
        }
        let before = self.previous.and_then(|previous| previous.skies.get(&key));
        let background = match before.filter(|asset| asset.is_of(&files)) {
            Some(asset) => asset.background.clone(),
            None => make(key.clone(), &files, self)?,
        };
        let asset = SkyAsset { files, background: background.clone() };
        self.count_bytes(asset.bytes())?;
        self.assets.skies.insert(key, asset);
        Ok(background)
    }
}

fn panorama(key: String, files: &[File], loader: &Loader) -> Result<Background, SceneError> {
    let (name, bytes) = files.first().expect("invariant: a panorama has a picture");
    let size = build::picture_size(name, bytes, loader.limits)?;
    loader.check_room(Panorama::bytes_of(size))?;
    let picture = build::picture(name, bytes, loader.limits)?;
    Ok(Background::Panorama(Arc::new(Panorama::new(key, picture))))
}

fn cube_map(
    key: String,
    files: &[File],
    loader: &Loader,
    place: &BackgroundPlace,
) -> Result<Background, SceneError> {
    let faults = |faults: Vec<FaceFault>| {
        let fault = |fault: FaceFault| Fault {
            pointer: format!("{}/faces/{}", place.pointer, FACES[fault.face()]),
            detail: fault.to_string(),
        };
        SceneError::Document(faults.into_iter().map(fault).collect())
    };
    // Six faces of one small file may be gigabytes: what they will take is known from the headers.
    let sizes: [PictureSize; 6] =
        each_once(files, |name, bytes| build::picture_size(name, bytes, loader.limits))?;
    loader.check_room(CubeMap::bytes_of(sizes).map_err(faults)?)?;
    let faces: [Arc<Picture>; 6] =
        each_once(files, |name, bytes| build::picture(name, bytes, loader.limits).map(Arc::new))?;
    CubeMap::new(key, faces).map(|map| Background::CubeMap(Arc::new(map))).map_err(faults)
}

/// What `make` makes of `N` files; of equal ones only once.
fn each_once<T: Clone, const N: usize>(
    files: &[File],
    make: impl Fn(&str, &Bytes) -> Result<T, SceneError>,
) -> Result<[T; N], SceneError> {
    let mut made: Vec<T> = Vec::with_capacity(N);
    for (at, (name, bytes)) in files.iter().enumerate() {
        // A name's ending counts too: by it alone is a TGA known.
        let is_like = |(other, content): &File| ending(other) == ending(name) && same_bytes(content, bytes);
        made.push(match files[..at].iter().position(is_like) {
            Some(earlier) => made[earlier].clone(),
            None => make(name, bytes)?,
        });
    }
    Ok(made.try_into().ok().expect("invariant: the caller names as many files"))
}

fn ending(name: &str) -> Option<&str> {
    name.rsplit_once('.').map(|(_, ending)| ending)
}
