//! Decodes the bytes of a file into text.

/// Whether bytes are an archive, as workbooks (.xlsx) are.
pub(super) fn is_workbook(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04")
}

/// Decodes the text of a file.
///
/// Understands UTF-8 with or without a byte order mark and UTF-16 as spreadsheets and Windows
/// programs write it. Anything else is read as Windows-1252, in which `µ` and `°` are single bytes.
///
/// # Errors
/// Bytes that are not text, with the kind of file if it is known.
pub fn decoded(bytes: &[u8]) -> Result<String, &'static str> {
    const KNOWN: [(&[u8], &str); 5] = [
        (b"PK\x03\x04", "a workbook of a spreadsheet (.xlsx) or an archive; save the sheet as CSV"),
        (b"ABF", "a binary file of Axon (.abf); export it as text (.atf)"),
        (b"\xd0\xcf\x11\xe0", "a workbook of an old spreadsheet (.xls); save it as .xlsx or CSV"),
        (b"\x89HDF", "an HDF5 or MATLAB file; export the curves as CSV"),
        (b"MATLAB 5.0", "a MATLAB file; export the curves as CSV (`writematrix`)"),
    ];
    if let Some((_, what)) = KNOWN.into_iter().find(|(start, _)| bytes.starts_with(start)) {
        return Err(what);
    }
    let wide = |bytes: &[u8], unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]])).collect();
        String::from_utf16_lossy(&units)
    };
    let text = match bytes {
        [0xef, 0xbb, 0xbf, rest @ ..] => String::from_utf8_lossy(rest).into_owned(),
        [0xff, 0xfe, rest @ ..] => wide(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => wide(rest, u16::from_be_bytes),
        // UTF-16 without a byte order mark: the first two letters of a table are ASCII, so one byte
        // of each is 0.
        [first, 0, third, 0, ..] if *first != 0 && *third != 0 => wide(bytes, u16::from_le_bytes),
        [0, second, 0, fourth, ..] if *second != 0 && *fourth != 0 => {
            wide(bytes, u16::from_be_bytes)
        }
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => text.to_owned(),
            Err(_) => bytes.iter().map(|byte| char::from(*byte)).collect(),
        },
    };
    if text.chars().any(|letter| letter.is_control() && !"\t\r\n\u{c}\u{1a}".contains(letter)) {
        return Err(
            "not a text file; export the curves as text or CSV from the program that wrote it",
        );
    }
    Ok(text.replace("\r\n", "\n").replace('\r', "\n").replace(['\u{1a}', '\u{c}'], ""))
}

#[cfg(test)]
mod tests {
    use super::decoded;

    #[test]
    fn every_encoding_of_a_table_gives_the_same_text() {
        let table = "time (s)\tlength (µm)\n0\t1,8\n";
        let units: Vec<u16> = table.encode_utf16().collect();
        let little: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
        let big: Vec<u8> = units.iter().flat_map(|unit| unit.to_be_bytes()).collect();
        for bytes in [
            table.as_bytes().to_vec(),
            [b"\xef\xbb\xbf", table.as_bytes()].concat(),
            [&[0xff, 0xfe], &little[..]].concat(),
            [&[0xfe, 0xff], &big[..]].concat(),
            little,
            big,
            table.replace('µ', "\u{1}").bytes().map(|b| if b == 1 { 0xb5 } else { b }).collect(),
            table.replace('\n', "\r\n").into_bytes(),
            table.replace('\n', "\r").into_bytes(),
        ] {
            assert_eq!(decoded(&bytes).unwrap(), table);
        }
    }

    #[test]
    fn what_is_no_text_says_what_it_is() {
        assert!(decoded(b"PK\x03\x04....").unwrap_err().contains(".xlsx"));
        assert!(decoded(b"\xd0\xcf\x11\xe0").unwrap_err().contains("save it as .xlsx"));
        assert!(decoded(b"IXT\x00\x01\x02\x03").unwrap_err().contains("not a text file"));
    }
}
