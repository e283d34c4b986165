//! ZIP archives of files that are compressed already.

/// The first day that a ZIP entry can have, 1 January 1980: the bytes depend on no clock.
const DATE: u16 = 1 << 5 | 1;
/// PKWARE's version 1.0: stored entries need no later one.
const VERSION: u16 = 10;
/// Names are UTF-8.
const FLAGS: u16 = 1 << 11;

/// An archive in the making: its entries are stored as they are (PKWARE APPNOTE 6.3).
#[derive(Debug, Default)]
pub struct Zip {
    bytes: Vec<u8>,
    /// Central directory headers of the entries so far.
    directory: Vec<u8>,
    entries: u16,
}

impl Zip {
    /// Adds a file.
    ///
    /// # Panics
    /// Beyond 4 GiB or 65535 entries; a few outputs of one picture stay far below.
    pub fn add(&mut self, name: &str, content: &[u8]) {
        let offset = size(self.bytes.len());
        let common = Self::common_header(name, content);
        self.bytes.extend(b"PK\x03\x04");
        self.bytes.extend(&common);
        self.bytes.extend(name.as_bytes());
        self.bytes.extend(content);

        self.directory.extend(b"PK\x01\x02");
        self.directory.extend(VERSION.to_le_bytes());
        self.directory.extend(&common);
        // No comment, disk 0, no attributes.
        self.directory.extend([0; 10]);
        self.directory.extend(offset.to_le_bytes());
        self.directory.extend(name.as_bytes());
        self.entries += 1;
    }

    /// What the header before an entry and its line in the directory share.
    fn common_header(name: &str, content: &[u8]) -> Vec<u8> {
        let stored = size(content.len());
        let name_bytes = u16::try_from(name.len()).expect("names of outputs are short");
        let [method, time, extra] = [0u16; 3];
        let mut header = Vec::new();
        [VERSION, FLAGS, method, time, DATE].iter().for_each(|field| header.extend(field.to_le_bytes()));
        let checksum = crc32fast::hash(content);
        [checksum, stored, stored].iter().for_each(|field| header.extend(field.to_le_bytes()));
        [name_bytes, extra].iter().for_each(|field| header.extend(field.to_le_bytes()));
        header
    }

    /// The whole archive.
    #[must_use]
    pub fn finish(mut self) -> Vec<u8> {
        let (offset, length) = (size(self.bytes.len()), size(self.directory.len()));
        self.bytes.append(&mut self.directory);
        self.bytes.extend(b"PK\x05\x06");
        // This disk, the directory's disk, entries here, entries in all.
        [0, 0, self.entries, self.entries].iter().for_each(|field| self.bytes.extend(field.to_le_bytes()));
        [length, offset].iter().for_each(|field| self.bytes.extend(field.to_le_bytes()));
        self.bytes.extend([0; 2]); // no comment
        self.bytes
    }
}

fn size(bytes: usize) -> u32 {
    u32::try_from(bytes).expect("the outputs of one picture stay below 4 GiB")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Cursor, Read};

    #[test]
    fn every_entry_comes_back_without_a_date() {
        let mut archive = Zip::default();
        let files: [(&str, &[u8]); 3] = [("a.png", b"picture"), ("leer.json", b""), ("größe", &[0, 255, 7])];
        files.iter().for_each(|(name, content)| archive.add(name, content));
        let bytes = archive.finish();

        let mut read = zip::ZipArchive::new(Cursor::new(bytes)).expect("an archive");
        assert_eq!(read.len(), files.len());
        for (at, (name, content)) in files.into_iter().enumerate() {
            let mut entry = read.by_index(at).expect("an entry");
            let mut bytes = Vec::new();
            entry.read_to_end(&mut bytes).expect("a matching checksum");
            assert_eq!(entry.name().expect("UTF-8"), name);
            assert_eq!(bytes, content);
            assert_eq!(
                entry.last_modified().map(|date| (date.year(), date.month(), date.day())),
                Some((1980, 1, 1))
            );
        }
    }
}
