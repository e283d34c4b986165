//! Backgrounds: their pictures, and computed skies.

use super::Loader;
use super::build;
use super::cache::SkyAsset;
use crate::limits::Limits;
use crate::model::sky::{CubeMap, Daylight, FaceFault, Panorama, Picture};
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
                let make = |_, _: &[File], _: &Limits| {
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
                    let make = |key, files: &[File], limits: &Limits| cube_map(key, files, limits, place);
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
    /// made of but the bytes of its files.
    fn sky(
        &mut self,
        key: String,
        files: Vec<File>,
        make: impl FnOnce(String, &[File], &Limits) -> Result<Background, SceneError>,
    ) -> Result<Background, SceneError> {
        if let Some(asset) = self.assets.skies.get(&key) {
            return Ok(asset.background.clone());
        }
        let before = self.previous.and_then(|previous| previous.skies.get(&key));
        let background = match before.filter(|asset| asset.is_of(&files)) {
            Some(asset) => asset.background.clone(),
            None => make(key.clone(), &files, self.limits)?,
        };
        let asset = SkyAsset { files, background: background.clone() };
        self.count_bytes(asset.bytes())?;
        self.assets.skies.insert(key, asset);
        Ok(background)
    }
}

fn panorama(key: String, files: &[File], limits: &Limits) -> Result<Background, SceneError> {
    let [picture] = pictures(files, limits)?;
    Ok(Background::Panorama(Arc::new(Panorama::new(key, picture))))
}

fn cube_map(
    key: String,
    files: &[File],
    limits: &Limits,
    place: &BackgroundPlace,
) -> Result<Background, SceneError> {
    let faces = pictures(files, limits)?;
    let faults = |faults: Vec<FaceFault>| {
        let fault = |fault: FaceFault| Fault {
            pointer: format!("{}/faces/{}", place.pointer, FACES[fault.face()]),
            detail: fault.to_string(),
        };
        SceneError::Document(faults.into_iter().map(fault).collect())
    };
    CubeMap::new(key, faces).map(|map| Background::CubeMap(Arc::new(map))).map_err(faults)
}

/// Decodes `N` files; each only once, however often it is named.
fn pictures<const N: usize>(files: &[File], limits: &Limits) -> Result<[Picture; N], SceneError> {
    let mut pictures: Vec<Picture> = Vec::with_capacity(N);
    for (at, (name, bytes)) in files.iter().enumerate() {
        let same = files[..at].iter().position(|(earlier, _)| earlier == name);
        pictures.push(match same {
            Some(earlier) => pictures[earlier].clone(),
            None => build::picture(name, bytes, limits)?,
        });
    }
    Ok(pictures.try_into().expect("invariant: the caller names as many files"))
}
