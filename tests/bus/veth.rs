//! The bus on a pair of virtual network interfaces, in a network namespace that the test makes itself.

use std::process::Command;

/// Brings both ends up, puts the bus on one and lists its devices from the other; a busy machine may miss an answer, so that
/// the list is tried for more than once.
const SCRIPT: &str = "ip link add ec0 type veth peer name ec1 && ip link set ec0 up && ip link set ec1 up || exit 77
\"$0\" rig emulate --interface ec1 & devices=$!
for try in 1 2 3 4 5 6 7 8 9 10; do
    sleep 0.2
    \"$0\" rig scan --interface ec0 --json && break
done
kill $devices";

/// What `ip` says of its failure.
const NO_LINK: i32 = 77;

#[test]
fn a_raw_socket_finds_the_devices() {
    let allowed = Command::new("unshare").args(["-Urn", "true"]).output().is_ok_and(|done| done.status.success());
    if !allowed {
        eprintln!("skipped: this machine allows no user namespaces, or has no unshare");
        return;
    }
    let binary = env!("CARGO_BIN_EXE_tautline");
    let done = Command::new("unshare").args(["-Urn", "sh", "-c", SCRIPT, binary]).output().unwrap();
    if done.status.code() == Some(NO_LINK) {
        eprintln!("skipped: no virtual interfaces here ({})", String::from_utf8_lossy(&done.stderr).trim());
        return;
    }
    let found: serde_json::Value = serde_json::from_slice(&done.stdout)
        .unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(&done.stderr)));
    let products: Vec<&serde_json::Value> =
        found["devices"].as_array().unwrap().iter().map(|device| &device["product"]).collect();
    assert_eq!(products, [0x0402, 0x0301]);
}
