//! `tautline model from`: what a robot's description says of a joint.

use crate::cli::tautline;
use serde_json::Value;
use std::path::Path;
use tautline::model::Model;
use tempfile::TempDir;

/// An arm of two hinges about y; 2 kg at 0.1 m and 1 kg at 0.3 + 0.1 m below the first, which is turned by its parent about z.
const MUJOCO: &str = r#"<mujoco>
  <compiler angle="radian"/>
  <default><joint damping="0.05"/><default class="arm"><joint frictionloss="0.12" armature="0.01"/></default></default>
  <worldbody>
    <body name="base" pos="0 0 1" euler="0 0 0.7" childclass="arm">
      <body name="upper">
        <joint name="shoulder" axis="0 1 0" stiffness="0.8" springref="0.1"/>
        <inertial pos="0 0 -0.1" mass="2" diaginertia="0.01 0.02 0.03"/>
        <body name="lower" pos="0 0 -0.3">
          <joint name="elbow" axis="0 1 0" damping="0.2"/>
          <inertial pos="0 0 -0.1" mass="1" diaginertia="0.001 0.002 0.003"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>"#;

fn from(text: &str, name: &str, joint: &str) -> (Value, Model) {
    let folder = TempDir::new().unwrap();
    let (robot, model) = (folder.path().join(name), folder.path().join("model.json"));
    std::fs::write(&robot, text).unwrap();
    let words = ["model", "from", &robot.to_string_lossy(), "--joint", joint, "-o", &model.to_string_lossy(), "--json"];
    let done = tautline(&words);
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    (serde_json::from_slice(&done.stdout).unwrap(), Model::read(&model).unwrap())
}

#[test]
fn a_mujoco_joint_becomes_a_model() {
    let (found, model) = from(MUJOCO, "arm.xml", "shoulder");
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} {b}: {found:#}");
    near(model.dynamics.inertia_kg_m2, 0.02 + 2.0 * 0.01 + 0.002 + 0.16 + 0.01);
    // Hanging down it weighs nothing at 0 and everything at a quarter turn.
    near(model.dynamics.gravity_nm, 9.81 * (2.0 * 0.1 + 0.4));
    near(model.dynamics.position_zero_rad, 0.0);
    near(model.friction.up.a_j, 0.12);
    near(model.friction.down.a_j, -0.12);
    near(model.friction.up.d, 0.05);
    assert_eq!(found["effects"][0]["id"], "elastic_spring");
    near(found["effects"][0]["parameters"]["preload_nm"].as_f64().unwrap(), -0.08);
    let (_, elbow) = from(MUJOCO, "arm.xml", "elbow");
    near(elbow.dynamics.inertia_kg_m2, 0.002 + 0.01 + 0.01);
    near(elbow.friction.up.d, 0.2);
}

#[test]
fn a_urdf_joint_becomes_a_model_and_a_missing_one_is_told() {
    let urdf = std::fs::read_to_string("data/arm/arm.urdf").unwrap();
    let name = urdf.split("<joint name=\"").nth(1).unwrap().split('"').next().unwrap().to_string();
    let (found, model) = from(&urdf, "arm.urdf", &name);
    assert!(model.dynamics.inertia_kg_m2 > 0.0, "{found:#}");
    let done = tautline(&["model", "from", "data/arm/arm.urdf", "--joint", "knee", "-o", "never.json"]);
    assert_eq!(done.status.code(), Some(2));
    assert!(!Path::new("never.json").exists());
}

#[test]
fn files_that_are_included_are_read() {
    let folder = TempDir::new().unwrap();
    let (start, rest) = MUJOCO.split_at(MUJOCO.find("  <default>").unwrap());
    let (defaults, rest) = rest.split_at(rest.find("  <worldbody>").unwrap());
    std::fs::write(folder.path().join("arm.xml"), format!("{start}<include file=\"joints.xml\"/>{rest}")).unwrap();
    std::fs::write(folder.path().join("joints.xml"), format!("<mujocoinclude>{defaults}</mujocoinclude>")).unwrap();
    let robot = folder.path().join("arm.xml");
    let found = tautline::robots::read(&robot, "shoulder").unwrap();
    assert_eq!(found, {
        std::fs::write(&robot, MUJOCO).unwrap();
        tautline::robots::read(&robot, "shoulder").unwrap()
    });
    assert_eq!((found.friction_nm, found.damping_nm_s_rad), (0.12, 0.05));
    std::fs::write(&robot, "<mujoco><include file=\"arm.xml\"/></mujoco>").unwrap();
    let endless = tautline::robots::read(&robot, "shoulder").unwrap_err();
    assert!(endless.to_string().contains("no end"), "{endless}");
}
