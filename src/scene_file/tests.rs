use super::*;

fn read(text: &str) -> Result<SceneFile, String> {
    let parsed = recipe::parse(text, "scenes/my.toml", &SCENE, |root, problems| {
        build(root, Path::new("scenes"), problems)
    });
    parsed.map_err(|errors| {
        let problems = errors.problems.iter();
        let lines = problems.map(|p| format!("{} ({:?})", p.message, p.hint));
        lines.collect::<Vec<_>>().join("; ")
    })
}

const SUN: &str =
    "species = \"mink\"\n[[lamps]]\nshape = \"sun\"\nyaw = 30\npitch = 40\nstrength = 2\n";

#[test]
fn every_key_is_read() {
    let text = "species = \"fur/my.toml\"\ncoat = \"leopard\"\ncolor = [0.5, 0.2, 0.1]\nset = [\"a.b=1\"]\nskin = \"cat.obj\"
skin_units = \"cm\"\nskin_up = \"z\"\nstrands = 1000\nseed = 7\nenv = \"sky\"\nenv_turn = -20
env_visible = true\nground = false\nview = [30, 5]\nfov = 20\nzoom = 2\nshift = [0.1, -0.2]
lens = 8\nfocus = 900\nres = [320, 200]\nspp = 16\nsampler = \"mis\"\nfilter = \"tent\"
look = \"filmic\"\nexposure = 1.5\n
[[lamps]]\nshape = \"rect\"\nyaw = 10\npitch = 20\nwith_camera = true\ndistance = 3\nsize = [1, 2]
strength = 2\ncolor = [1, 0.5, 0.25]\n[[lamps]]\nshape = \"sphere\"\nyaw = 0\npitch = -5\ndistance = 2
radius = 0.5\nstrength = 1\n[[lamps]]\nshape = \"sun\"\nyaw = 1\npitch = 2\nstrength = 1\n";
    let lamp = |shape, yaw_deg, pitch_deg, strength| Lamp {
        shape,
        yaw_deg,
        pitch_deg,
        strength,
    };
    let (distance, size, radius) = (3.0, [1.0, 2.0], 0.5);
    let rect = LampShape::Rect { distance, size };
    let distance = 2.0;
    let ball = LampShape::Sphere { distance, radius };
    let sun = LampShape::Sun { diameter_deg: 0.53 };
    let expected = SceneFile {
        species: "scenes/fur/my.toml".into(),
        coat: Some("leopard".into()),
        color: Some([0.5, 0.2, 0.1]),
        set: vec!["a.b=1".into()],
        skin: Some("scenes/cat.obj".into()),
        skin_units: Some("cm"),
        skin_up: Some("z"),
        strands: Some(1000),
        seed: Some(7),
        env: Some("sky".into()),
        env_turn: Some(-20.0),
        env_visible: Some(true),
        ground: Some(false),
        lamps: vec![
            (lamp(rect, 10.0, 20.0, Rgb::new(2.0, 1.0, 0.5)), true),
            (lamp(ball, 0.0, -5.0, Rgb::ONE), false),
            (lamp(sun, 1.0, 2.0, Rgb::ONE), false),
        ],
        view: Some([30.0, 5.0]),
        fov: Some(20.0),
        zoom: Some(2.0),
        shift: Some([0.1, -0.2]),
        lens: Some(8.0),
        focus: Some(900.0),
        res: Some([320, 200]),
        spp: Some(16),
        sampler: Some("mis"),
        filter: Some("tent"),
        look: Some("filmic"),
        exposure: Some(1.5),
    };
    assert_eq!(read(text).unwrap(), expected);
    // No key is left out of this test.
    for field in SCENE.fields {
        assert!(
            text.contains(&format!("{} = ", field.key)) || field.key == "lamps",
            "{}",
            field.key
        );
    }
}

#[test]
fn only_files_with_a_species_are_scenes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.toml");
    let name = path.to_str().unwrap();
    std::fs::write(&path, SUN).unwrap();
    assert_eq!(SceneFile::read(name).unwrap().unwrap().species, "mink");
    std::fs::write(&path, crate::species::LIBRARY[0].1).unwrap();
    assert_eq!(SceneFile::read(name).unwrap(), None);
    assert_eq!(SceneFile::read("mink").unwrap(), None);
    let long = format!("{}#{}", crate::species::LIBRARY[0].1, "x".repeat(300_000));
    std::fs::write(&path, long).unwrap();
    assert_eq!(SceneFile::read(name).unwrap(), None);
    assert!(crate::species::load(name, &[]).is_ok());
}

#[test]
fn scenes_of_the_examples_are_read() {
    for folder in ["examples/scenes", "benches/peers"] {
        let entries = std::fs::read_dir(folder).unwrap();
        let paths = entries.map(|entry| entry.unwrap().path());
        let scenes: Vec<_> = paths
            .filter(|p| p.extension().is_some_and(|e| e == "toml"))
            .collect();
        assert!(!scenes.is_empty(), "{folder}");
        for path in scenes {
            let scene = SceneFile::read(path.to_str().unwrap()).unwrap().unwrap();
            assert!(
                !scene.lamps.is_empty() && crate::species::load(&scene.species, &scene.set).is_ok()
            );
        }
    }
}

#[test]
fn what_is_wrong_is_said_with_its_key() {
    for (from, to, complaint) in [
        (
            "strength = 2",
            "strenght = 2",
            "unknown key `lamps.0.strenght`",
        ),
        (
            "strength = 2",
            "strength = -1",
            "`lamps.0.strength` is -1, expected a number from 0",
        ),
        (
            "pitch = 40",
            "pitch = 100",
            "expected a number from -90 to 90 degrees",
        ),
        ("\"sun\"", "\"rect\"", "`lamps.0.distance` is missing"),
        (
            "\"sun\"",
            "\"rect\"\ndistance = 2",
            "`lamps.0.size` is missing",
        ),
        ("\"sun\"", "\"moon\"", "expected one of rect, sphere, sun"),
        (
            "\"sun\"",
            "\"sun\"\ndistance = 2",
            "`lamps.0.distance` has no meaning with shape \"sun\"",
        ),
        (
            "\"sun\"",
            "\"sphere\"\ndistance = 1\nradius = 1",
            "`lamps.0.radius` is 1, expected less than the distance",
        ),
        (
            "species = \"mink\"",
            "species = \"mink\"\nground = 1",
            "`ground` is 1, expected true or false",
        ),
        (
            "species = \"mink\"",
            "species = \"mink\"\nview = [1]",
            "`view` is an array of 1, expected 2 numbers",
        ),
    ] {
        let error = read(&SUN.replace(from, to)).unwrap_err();
        assert!(error.contains(complaint), "{error}");
    }
}
