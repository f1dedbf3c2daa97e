//! Plain text tables.

/// Lines of columns, each as wide as its widest cell; the first column is
/// flush left, the others flush right. Markdown if `bars`.
pub fn table(header: &[&str], rows: &[Vec<String>], bars: bool) -> String {
    let mut widths: Vec<usize> = header.iter().map(|h| h.chars().count()).collect();
    for row in rows {
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = (*width).max(cell.chars().count());
        }
    }
    let header: Vec<String> = header.iter().map(ToString::to_string).collect();
    let mut lines = vec![line(&header, &widths, bars)];
    if bars {
        lines.push(rule(&widths));
    }
    lines.extend(rows.iter().map(|row| line(row, &widths, bars)));
    lines.join("\n")
}

fn line(cells: &[String], widths: &[usize], bars: bool) -> String {
    let padded: Vec<String> = (cells.iter().zip(widths).enumerate())
        .map(|(column, (cell, &width))| match column {
            0 => format!("{cell:<width$}"),
            _ => format!("{cell:>width$}"),
        })
        .collect();
    if bars {
        return format!("| {} |", padded.join(" | "));
    }
    padded.join("  ").trim_end().to_owned()
}

fn rule(widths: &[usize]) -> String {
    let dashes = |(column, &width): (usize, &usize)| match column {
        0 => "-".repeat(width.max(1)),
        _ => format!("{}:", "-".repeat(width.max(2) - 1)),
    };
    let cells: Vec<String> = widths.iter().enumerate().map(dashes).collect();
    format!("| {} |", cells.join(" | "))
}

/// A count with its thousands set apart: `69,451`.
pub fn count(n: usize) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A size in bytes with its unit: `1.24 MB` (1000 bytes are 1 kB).
pub fn bytes(n: u64) -> String {
    let scaled = |unit: f64| n as f64 / unit;
    match n {
        0..1_000 => format!("{n} B"),
        1_000..1_000_000 => format!("{:.1} kB", scaled(1e3)),
        1_000_000..1_000_000_000 => format!("{:.2} MB", scaled(1e6)),
        _ => format!("{:.2} GB", scaled(1e9)),
    }
}

/// A length with four significant digits.
pub fn number(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    if !x.is_finite() || !(1e-4..1e7).contains(&x.abs()) {
        return format!("{x:.3e}");
    }
    let decimals = (3 - x.abs().log10().floor() as i32).clamp(0, 7) as usize;
    format!("{x:.decimals$}")
}

/// A share as a percentage with three significant digits.
pub fn percent(share: f64) -> String {
    let p = share * 100.0;
    if p == 0.0 {
        return "0 %".into();
    }
    if p.abs() < 1e-3 {
        return format!("{p:.1e} %");
    }
    let decimals = (2 - p.abs().log10().floor() as i32).clamp(0, 5) as usize;
    format!("{p:.decimals$} %")
}

/// A duration in seconds.
pub fn seconds(time: std::time::Duration) -> String {
    format!("{:.2} s", time.as_secs_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up() {
        let rows = [
            vec!["a".to_owned(), "1".into()],
            vec!["bcd".into(), "200".into()],
        ];
        let plain = "name    n\na       1\nbcd   200";
        assert_eq!(table(&["name", "n"], &rows, false), plain);
        let bars = "| name |   n |\n| ---- | --: |\n| a    |   1 |\n| bcd  | 200 |";
        assert_eq!(table(&["name", "n"], &rows, true), bars);
    }

    #[test]
    fn numbers_read_well() {
        assert_eq!(
            [0, 999, 1000, 1_234_567].map(count),
            ["0", "999", "1,000", "1,234,567"]
        );
        assert_eq!(
            [0, 999, 1500, 2_345_678].map(bytes),
            ["0 B", "999 B", "1.5 kB", "2.35 MB"]
        );
        let numbers = [0.0, 1.0, 0.012_345, 1234.5, 1e-9, f64::INFINITY].map(number);
        assert_eq!(
            numbers,
            ["0", "1.000", "0.01235", "1234", "1.000e-9", "inf"]
        );
        assert_eq!(
            [0.0, 0.5, 0.000_123, 1e-7].map(percent),
            ["0 %", "50.0 %", "0.0123 %", "1.0e-5 %"]
        );
    }
}
