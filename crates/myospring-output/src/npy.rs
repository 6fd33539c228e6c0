//! NumPy's file of one array, `.npy`, written record by record: curves of many members without
//! holding them in memory.
//!
//! `numpy.load(path, mmap_mode="r")` reads it without loading it.

use crate::files::FileError;
use crate::npz::header;
use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Bytes of a number.
const WIDTH: usize = 4;

/// An array of 32-bit floats on the disk, whose records (the entries of one first index) are
/// written in any order. Records that were not written are NaN.
#[derive(Debug)]
pub struct Records {
    path: PathBuf,
    file: File,
    /// Offset of the first number, bytes.
    start: u64,
    /// Number of values per record.
    length: usize,
    count: usize,
}

impl Records {
    /// Goes on with a file of this shape, or begins one, all NaN. Where records of this shape are fewer or more, those
    /// that are wanted stay.
    ///
    /// # Errors
    /// A file that cannot be read or written.
    ///
    /// # Example
    /// ```
    /// use myospring::output::npy::Records;
    /// # let folder = tempfile::tempdir()?;
    /// # let path = folder.path().join("traces.npy");
    /// let mut records = Records::open(&path, &[3, 2])?;
    /// records.write(1, &[0.5, 1.5])?;
    /// assert_eq!(records.read(1)?, [0.5, 1.5]);
    /// assert!(records.read(2)?.iter().all(|number| number.is_nan()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn open(path: &Path, shape: &[usize]) -> Result<Self, FileError> {
        let failed = |source| FileError::Write { path: path.to_owned(), source };
        let header = header("<f4", shape);
        let count = shape.first().copied().unwrap_or(0);
        let length: usize = shape.iter().skip(1).product();
        let mut options = OpenOptions::new();
        let mut file = options
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path)
            .map_err(failed)?;
        let mut there = vec![0; header.len()];
        let bytes = file.metadata().map_err(failed)?.len().saturating_sub(header.len() as u64);
        let record = (length * WIDTH) as u64;
        let held = bytes.checked_div(record).unwrap_or(0) as usize;
        let held_shape: Vec<usize> =
            std::iter::once(held).chain(shape.iter().skip(1).copied()).collect();
        let whole = bytes.checked_rem(record) == Some(0)
            && file.read_exact(&mut there).is_ok()
            && there == self::header("<f4", &held_shape);
        let kept = if whole { held.min(count) } else { 0 };
        if kept < count || held != count {
            let start = header.len() as u64 + kept as u64 * record;
            resume(&mut file, &header, start, (count - kept) * length).map_err(failed)?;
        }
        Ok(Self { path: path.to_owned(), file, start: header.len() as u64, length, count })
    }

    /// Number of records.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Writes a record and returns it as written: numbers beyond its length are left out, missing
    /// ones are NaN.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&mut self, record: usize, numbers: &[f32]) -> Result<Vec<f32>, FileError> {
        let numbers = numbers.iter().copied().chain(std::iter::repeat(f32::NAN));
        let numbers: Vec<f32> = numbers.take(self.length).collect();
        let bytes: Vec<u8> = numbers.iter().copied().flat_map(f32::to_le_bytes).collect();
        let written = self.at(record).and_then(|()| self.file.write_all(&bytes));
        written.map(|()| numbers).map_err(|source| self.failed(source))
    }

    /// Reads a record.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn read(&mut self, record: usize) -> Result<Vec<f32>, FileError> {
        let mut bytes = vec![0; WIDTH * self.length];
        let read = self.at(record).and_then(|()| self.file.read_exact(&mut bytes));
        read.map_err(|source| self.failed(source))?;
        let (numbers, _) = bytes.as_chunks::<WIDTH>();
        Ok(numbers.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect())
    }

    /// Flushes everything written to the disk.
    ///
    /// # Errors
    /// A disk that is full or gone.
    pub fn sync(&self) -> Result<(), FileError> {
        self.file.sync_data().map_err(|source| self.failed(source))
    }

    fn at(&mut self, record: usize) -> io::Result<()> {
        let place = self.start + (record * self.length * WIDTH) as u64;
        self.file.seek(SeekFrom::Start(place)).map(|_| ())
    }

    fn failed(&self, source: io::Error) -> FileError {
        FileError::Write { path: self.path.clone(), source }
    }
}

/// Writes the header, and cuts the file at `start` to go on with NaN.
fn resume(file: &mut File, header: &[u8], start: u64, numbers: usize) -> io::Result<()> {
    file.set_len(start)?;
    file.seek(SeekFrom::Start(0))?;
    file.write_all(header)?;
    file.seek(SeekFrom::Start(start))?;
    let mut writer = BufWriter::new(&mut *file);
    for _ in 0..numbers {
        writer.write_all(&f32::NAN.to_le_bytes())?;
    }
    writer.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_written_stays_when_the_file_is_opened_again_and_records_of_another_shape_begin_anew()
     {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("traces.npy");
        let open = |shape: &[usize]| Records::open(&path, shape).unwrap();
        open(&[4, 3, 2]).write(3, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
        open(&[4, 3, 2]).write(0, &[7.0]).unwrap();
        let mut again = open(&[4, 3, 2]);
        assert_eq!(again.read(3).unwrap(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(again.read(0).unwrap()[0].to_bits(), 7.0_f32.to_bits());
        assert!(again.read(0).unwrap()[1..].iter().all(|number| number.is_nan()));
        let mut more = open(&[1200, 3, 2]);
        assert_eq!(more.read(3).unwrap(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert!((4..1200).all(|at| more.read(at).unwrap().iter().all(|number| number.is_nan())));
        let bytes = std::fs::metadata(&path).unwrap().len();
        assert_eq!(bytes, (header("<f4", &[1200, 3, 2]).len() + 4 * 1200 * 6) as u64);
        let mut fewer = open(&[2, 3, 2]);
        assert_eq!(fewer.read(0).unwrap()[0].to_bits(), 7.0_f32.to_bits());
        assert!(open(&[4, 3, 2]).read(3).unwrap().iter().all(|number| number.is_nan()));
        assert!(open(&[4, 3, 3]).read(3).unwrap().iter().all(|number| number.is_nan()));
    }
}
