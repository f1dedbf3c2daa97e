//! `karui bench hlod`: every experiment on few objects.
#![allow(clippy::unwrap_used, reason = "it is a test")]

mod common;

use common::Folder;
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

#[test]
fn builds_and_flights_are_tabulated_by_size() {
    let folder = Folder::new();
    folder.write("page.md", "# Mine\n");
    let ran = folder.ok("bench hlod --counts 50,400 --frames 5 -o page.md --json");
    let rows = &ran.json()["counts"];
    let sizes: Vec<u64> = (0..4)
        .map(|i| rows[i]["objects"].as_u64().unwrap())
        .collect();
    assert_eq!(sizes, [50, 400, 50, 400]);
    for row in rows.as_array().unwrap() {
        let lists = row["lists"].as_array().unwrap();
        let triangles: Vec<f64> = lists.iter().map(|l| number(&l["triangles"])).collect();
        assert!(triangles.is_sorted_by(|a, b| a >= b), "{row}");
        let [median, late, worst] = [0, 1, 2].map(|i| number(&lists[0]["milliseconds"][i]));
        assert!(0.0 < median && median <= late && late <= worst, "{row}");
    }
    let page = String::from_utf8(folder.read("page.md")).unwrap();
    assert!(page.starts_with("# Mine\n"), "{page}");
    assert!(page.contains("<!-- begin: karui bench hlod --counts -->"));
    assert!(page.contains("| forest |     400 |"), "{page}");
}

#[test]
fn the_papers_experiments_come_out_as_there() {
    let folder = Folder::new();
    let found = folder
        .ok("bench hlod --paper --pictures pictures --json")
        .json();
    let stands = found["paper"]["stands"].as_array().unwrap();
    let curve = |i: usize| -> Vec<f64> {
        let triangles = stands[i]["triangles"].as_array().unwrap();
        triangles.iter().map(number).collect()
    };
    for pair in [0, 2] {
        let [single, mixed] = [curve(pair), curve(pair + 1)];
        assert_eq!((single[0], mixed[0]), (384.0, 384.0));
        assert!(single.is_sorted_by(|a, b| a >= b) && mixed.is_sorted_by(|a, b| a >= b));
        assert!(single.iter().zip(&mixed).all(|(s, m)| s <= m));
        assert!(single.iter().zip(&mixed).any(|(s, m)| s < m));
    }
    let wide = found["paper"]["wide"].as_array().unwrap();
    assert!(number(&wide[0]["flip"]) > 0.0 && number(&wide[0]["groups"]) == 0.0);
    assert!(wide.is_sorted_by(|a, b| number(&a["triangles"]) >= number(&b["triangles"])));
    assert_eq!(
        folder.names("pictures"),
        ["hlod-curve.svg", "hlod-wide.png"]
    );
    let svg = String::from_utf8(folder.read("pictures/hlod-curve.svg")).unwrap();
    assert_eq!(svg.matches("<polyline").count(), 4);
}

#[test]
fn groupings_are_compared_with_as_many_triangles() {
    let folder = Folder::new();
    let args = "bench hlod --groupings --objects 30 --views 2 --models none";
    let found = folder.ok(&format!("{args} --json --threads 1")).json();
    let rows = found["groupings"].as_array().unwrap();
    let none = number(&rows[0]["means"][0]["triangles"]);
    assert_eq!(rows.len(), 13);
    for row in &rows[1..] {
        for (mean, share) in row["means"].as_array().unwrap().iter().zip([0.5, 0.2]) {
            let kept = number(&mean["triangles"]) <= share * none;
            assert!(kept || number(&mean["beyond"]) > 0.0, "{row}");
            assert!((0.0..1.0).contains(&number(&mean["flip"])), "{row}");
        }
    }
    let again = folder
        .ok(&format!("{args} --json --threads 4 -o page.md"))
        .json();
    assert_eq!(found, again, "the same for any number of threads");
    let text = String::from_utf8(folder.read("page.md")).unwrap();
    assert!(text.contains("left out: city, engine"), "{text}");
}

#[test]
fn what_cannot_be_run_is_refused() {
    let folder = Folder::new();
    folder.fails(2, "bench hlod");
    folder.fails(2, "bench hlod --counts 0");
    folder.fails(2, "bench hlod --groupings --objects 1");
}
