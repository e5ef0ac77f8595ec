//! Generates `src/gen/` again from the schema and compares, so that neither can change alone.
//!
//! After a change of the schema: `PORTAMENTO_REGENERATE=1 cargo test -p portamento-proto --test generated`.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests may panic as tests do")]

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use prost::Message as _;

const FILES: [&str; 4] = [
    "motion/v1/plan.proto",
    "motion/v1/setpoint.proto",
    "motion/v1/sim_axis.proto",
    "motion/v1/recording.proto",
];

/// What is sent seldom, and is so much larger than the messages beside it that it is boxed.
const LARGE: [&str; 3] = [
    ".motion.v1.StreamSetpointsRequest.message.open",
    ".motion.v1.StreamSetpointsResponse.message.opened",
    ".motion.v1.StreamSetpointsResponse.message.revised",
];

/// What a server says with plans in bytes.
const OUTGOING: [&str; 3] = ["PlanResponse", "PlanManyResponse", "PlanPvtResponse"];

#[test]
fn checked_in_code_follows_from_the_schema() {
    check(&generated());
}

#[test]
fn descriptor_set_is_complete() {
    let set = prost_types::FileDescriptorSet::decode(proto::FILE_DESCRIPTOR_SET).unwrap();
    let names: Vec<&str> = set.file.iter().map(|file| file.name()).collect();
    // Imports first, as reflection and JSON need them too.
    assert_eq!(names, [&["google/protobuf/duration.proto"], &FILES[..]].concat());
}

/// File name and contents of everything in `src/gen/`.
type Generated = [(&'static str, Vec<u8>); 3];

fn check(generated: &Generated) {
    let folder = root().join("src/gen");
    for (name, fresh) in generated {
        let path = folder.join(name);
        if env::var_os("PORTAMENTO_REGENERATE").is_some() {
            fs::create_dir_all(&folder).unwrap();
            fs::write(&path, fresh).unwrap();
        }
        let checked_in = fs::read(&path).unwrap_or_default();
        assert!(
            checked_in == *fresh,
            "{} differs from what the schema gives: run \
             `PORTAMENTO_REGENERATE=1 cargo test -p portamento-proto --test generated` and commit the result",
            path.display()
        );
    }
}

fn generated() -> Generated {
    // Comments become documentation of the Rust types, and are left out of the descriptor set, where they
    // would treble its size.
    let mut set = protox::compile(FILES, [root()]).unwrap();
    let out = Scratch::new();
    let mut config = tonic_prost_build::Config::new();
    config.enable_type_names();
    // Each stream has room for some messages on both sides, and nearly all of them are small.
    for large in LARGE {
        config.boxed(large);
    }
    let builder = || tonic_prost_build::configure().out_dir(out.path()).emit_rerun_if_changed(false);
    builder()
        .build_server(false)
        // Written by hand, since there are so many of them.
        .extern_path(".motion.v1.AxisSegment", "crate::piece::AxisSegment")
        .compile_fds_with_config(set.clone(), config)
        .unwrap();
    let file = out.path().join("motion.v1.rs");
    let code = fs::read(&file).unwrap();
    OUTGOING
        .iter()
        .fold(builder().build_client(false), |builder, message| {
            builder.extern_path(format!(".motion.v1.{message}"), format!("crate::outgoing::{message}"))
        })
        .extern_path(".motion.v1", "crate::pb")
        .compile_fds(set.clone())
        .unwrap();
    let services = fs::read(&file).unwrap();

    for file in &mut set.file {
        file.source_code_info = None;
    }
    [("motion.v1.rs", code), ("services.rs", services), ("descriptor.bin", set.encode_to_vec())]
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A folder of this process's own inside cargo's folder for tests, removed in the end.
struct Scratch(PathBuf);

impl Scratch {
    fn new() -> Self {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("generated-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}
