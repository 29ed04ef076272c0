//! A data card of a board: Croissant 1.0, JSON-LD (MLCommons, 2024), so that tools for data sets find its tables and columns.

use serde_json::{Value, json};

use super::row::{HEADINGS, shown_hash, whole_hash};
use super::{ARENA_VERSION, Track};
use crate::plan::PROGRAM_VERSION;

/// The meaning of each column of a file of rows, and its type.
const COLUMNS: [(&str, &str); 6] = [
    ("name of the entry", "sc:Text"),
    ("condition under which it played; empty on tracks with only one", "sc:Text"),
    ("seed of all randomness in the run", "sc:Integer"),
    ("score of the run; empty if it failed", "sc:Float"),
    ("expansions of the run; of a module, millions of its instructions", "sc:Integer"),
    ("first 16 hexadecimal digits of SHA-256 over the outcomes of the run", "sc:Text"),
];

/// Describes the files of rows of a board, given with their texts.
pub(super) fn data_card(files: &[(&Track, String)]) -> Value {
    // The version contains a hash of all rows, so that a tool that cached an older board sees that it is another.
    let all: String = files.iter().map(|(_, text)| text.as_str()).collect();
    let distribution = files.iter().map(|(track, text)| {
        json!({
            "@type": "cr:FileObject",
            "@id": format!("{}.csv", track.name),
            "name": format!("{}.csv", track.name),
            "contentUrl": format!("{}.csv", track.name),
            "encodingFormat": "text/csv",
            "sha256": whole_hash(text),
        })
    });
    let record_sets = files.iter().map(|(track, _)| {
        let fields = HEADINGS.into_iter().zip(COLUMNS).map(|(heading, (description, of))| {
            json!({
                "@type": "cr:Field",
                "@id": format!("{}/{heading}", track.name),
                "name": heading,
                "description": description,
                "dataType": of,
                "source": {
                    "fileObject": { "@id": format!("{}.csv", track.name) },
                    "extract": { "column": heading },
                },
            })
        });
        json!({
            "@type": "cr:RecordSet",
            "@id": track.name,
            "name": track.name,
            "description": format!("A row for each run of the track, scored by {}.", track.metric().name),
            "field": fields.collect::<Vec<_>>(),
        })
    });
    json!({
        "@context": context(),
        "@type": "sc:Dataset",
        "name": format!("wildfire-arena-{ARENA_VERSION}"),
        "description": "Runs of planners and policies on the frozen tracks of the wildfire arena. Every row can be played again.",
        "conformsTo": "http://mlcommons.org/croissant/1.0",
        "license": "https://creativecommons.org/publicdomain/zero/1.0/",
        "version": format!("{ARENA_VERSION}.0+{}", shown_hash(&all)),
        "citeAs": format!("wildfire {PROGRAM_VERSION}, arena {ARENA_VERSION}"),
        "distribution": distribution.collect::<Vec<_>>(),
        "recordSet": record_sets.collect::<Vec<_>>(),
    })
}

/// The context of Croissant 1.0: the names that it gives its own meaning, and those of JSON-LD that they need.
fn context() -> Value {
    const TERMS: [&str; 24] = [
        "citeAs",
        "column",
        "extract",
        "field",
        "fileObject",
        "fileProperty",
        "fileSet",
        "format",
        "includes",
        "isLiveDataset",
        "jsonPath",
        "key",
        "md5",
        "parentField",
        "path",
        "recordSet",
        "references",
        "regex",
        "repeated",
        "replace",
        "samplingRate",
        "separator",
        "source",
        "subField",
    ];
    let mut context = json!({
        "@language": "en",
        "@vocab": "https://schema.org/",
        "sc": "https://schema.org/",
        "cr": "http://mlcommons.org/croissant/",
        "rai": "http://mlcommons.org/croissant/RAI/",
        "dct": "http://purl.org/dc/terms/",
        "conformsTo": "dct:conformsTo",
        "data": { "@id": "cr:data", "@type": "@json" },
        "dataType": { "@id": "cr:dataType", "@type": "@vocab" },
        "equivalentProperty": "cr:equivalentProperty",
        "examples": { "@id": "cr:examples", "@type": "@json" },
        "transform": "cr:transform",
    });
    TERMS.iter().for_each(|name| context[name] = format!("cr:{name}").into());
    context
}
