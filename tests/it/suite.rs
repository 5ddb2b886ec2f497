//! Many runs: `drape evaluate` and `drape batch`.

use crate::support::Workplace;

const MANIFEST: &str = "presets = ['short.toml', 'initial']\nseeds = [0, 1]\n\
    [[pair]]\nname = 'ball'\nsource = 'source.obj'\ntarget = 'target.ply'\nlandmarks = 'landmarks.json'\n\
    judge = 'target.ply'\n\
    [[pair]]\nname = 'broken'\nsource = 'missing.obj'\ntarget = 'target.ply'\n";

#[test]
fn an_evaluation_goes_on_after_failures_and_resumes() {
    let place = Workplace::new();
    place.write("suite.toml", MANIFEST);
    let first = place.drape("evaluate suite.toml -o runs --jobs 2");
    assert_eq!(first.code, Some(1), "{}", first.stderr);
    assert!(
        first.stdout.starts_with("3 of 6 runs done"),
        "{}",
        first.stdout
    );
    assert!(first.stderr.contains("missing.obj"));
    assert_eq!(place.read("runs/results.csv").lines().count(), 7);
    assert_eq!(place.read("runs/results.jsonl").lines().count(), 6);
    let html = place.read("runs/index.html");
    assert!(
        html.contains("ball/short-0.png")
            && html.contains("ball/initial-0.png")
            && html.contains("missing.obj")
    );
    assert!(place.exists("runs/ball/short-1.png"));

    let again = place.drape("evaluate suite.toml -o runs");
    assert!(
        again.stderr.starts_with("6 runs, 3 done before"),
        "{}",
        again.stderr
    );
    std::fs::remove_file(place.path("runs/ball/short-1.obj")).expect("a result is removed");
    let repaired = place.drape("evaluate suite.toml -o runs");
    assert!(
        repaired.stderr.starts_with("6 runs, 2 done before"),
        "{}",
        repaired.stderr
    );
    assert!(place.exists("runs/ball/short-1.obj"));
}

#[test]
fn a_batch_names_its_outputs_from_a_pattern() {
    let place = Workplace::new();
    std::fs::copy(place.path("target.ply"), place.path("second.ply")).expect("a copy");
    std::fs::copy(place.path("landmarks.json"), place.path("second.json")).expect("a copy");
    std::fs::copy(place.path("landmarks.json"), place.path("target.json")).expect("a copy");
    let line = "batch source.obj target.ply second.ply third.ply -l {target}.json -o done/{source}-{target}.obj --config short.toml";
    let ended = place.drape(line);
    assert_eq!(ended.code, Some(2));
    assert!(place.exists("done/source-target.obj") && place.exists("done/source-second.obj"));
    assert!(!place.exists("done/source-third.obj"));
    assert!(place.exists("drape-batch/index.html"));

    let clash = place.drape("batch source.obj target.ply second.ply -o one.obj");
    assert_eq!((clash.code, clash.stderr.lines().count()), (Some(2), 1));
}

#[test]
fn parts_of_a_batch_come_together_in_one_table() {
    let place = Workplace::new();
    for name in ["second.ply", "third.ply"] {
        std::fs::copy(place.path("target.ply"), place.path(name)).expect("a copy");
    }
    let line =
        "batch source.obj target.ply second.ply third.ply -o done/{target}.obj --config short.toml";
    for (part, n) in [("1/2", 2), ("2/2", 1)] {
        let ended = place.drape(&format!("{line} --shard {part}")).well();
        let told = format!("{n} of {n} runs of this part done");
        assert!(ended.stdout.contains(&told), "{}", ended.stdout);
    }
    assert!(!place.exists("drape-batch/results.csv"));
    let again = place.drape(&format!("{line} --shard 1/2")).well();
    assert!(again.stderr.starts_with("2 runs, 2 done before"));
    let whole = place.drape(line).well();
    assert!(
        whole.stderr.starts_with("3 runs, 3 done before"),
        "{}",
        whole.stderr
    );
    assert_eq!(place.read("drape-batch/results.csv").lines().count(), 4);
    let beyond = place.drape(&format!("{line} --shard 3/2"));
    assert_eq!((beyond.code, beyond.stderr.lines().count()), (Some(2), 1));
}

#[test]
fn what_is_left_of_a_listed_batch_is_told_by_number() {
    let place = Workplace::new();
    std::fs::copy(place.path("target.ply"), place.path("second.ply")).expect("a copy");
    place.write("list.txt", "target.ply\n\nsecond.ply\nthird.ply\n");
    let line = "batch source.obj --targets-from list.txt -o done/{target}.obj --config short.toml";
    assert_eq!(
        place.drape(&format!("{line} --left")).well().stdout,
        "1\n2\n3\n"
    );
    place.drape(&format!("{line} --shard 2/3")).well();
    assert_eq!(
        place.drape(&format!("{line} --left")).well().stdout,
        "1\n3\n"
    );
    assert!(!place.exists("done/target.obj"));

    let listed_twice = place.drape(&format!("{line} second.ply --left"));
    assert_eq!(
        (listed_twice.code, listed_twice.stderr.lines().count()),
        (Some(2), 1)
    );
    place.write("list.txt", "\n");
    let none = place.drape(&format!("{line} --left"));
    assert!(
        none.code == Some(2) && none.stderr.contains("names no target"),
        "{}",
        none.stderr
    );
}

#[test]
fn frames_of_a_motion_start_from_those_before() {
    let place = Workplace::new();
    for name in ["b.ply", "c.ply"] {
        std::fs::copy(place.path("target.ply"), place.path(name)).expect("a copy");
    }
    std::fs::copy(place.path("landmarks.json"), place.path("target.json")).expect("a copy");
    let line = "batch source.obj target.ply b.ply c.ply -l {target}.json -o done/{target}.obj --config short.toml --sequence --smooth-change 50";
    place.drape(line).well();
    let rows: serde_json::Value =
        serde_json::from_str(&place.read("drape-batch/results.json")).expect("JSON");
    let commands: Vec<String> = (rows.as_array().expect("rows").iter())
        .map(|row| row["command"].to_string())
        .collect();
    assert!(!commands[0].contains("--from") && commands[0].contains("--landmarks"));
    assert!(commands[1].contains("done/target.obj") && commands[2].contains("done/b.obj"));
    assert!(commands[2].contains(r#""--first-frame","done/target.obj""#));
    assert!(!commands[1].contains("--landmarks"));
    let evenly: Vec<bool> = (commands.iter())
        .map(|command| command.contains("--smooth-change=50"))
        .collect();
    assert_eq!(evenly, [false, true, true]);
    let again = place.drape(line).well();
    assert!(
        again.stderr.starts_with("3 runs, 3 done before"),
        "{}",
        again.stderr
    );
    assert_eq!(place.drape(&format!("{line} --jobs 2")).code, Some(2));
}

#[test]
fn a_manifest_with_a_mistake_is_refused_before_any_run() {
    let place = Workplace::new();
    place.write(
        "suite.toml",
        "presets = ['best']\n[[pair]]\nsource = 'source.obj'\ntarget = 'target.ply'\n",
    );
    let ended = place.drape("evaluate suite.toml -o runs");
    assert_eq!((ended.code, ended.stderr.lines().count()), (Some(2), 1));
    assert!(ended.stderr.contains("suite.toml") && ended.stderr.contains("best"));
    assert!(!place.exists("runs"));
}

#[test]
fn a_bench_of_creatures_tells_how_much_nearer_to_the_truth_results_are() {
    let place = Workplace::new();
    let line = "bench --plan head,insect --landmarks 8 --seeds 1 --preset short.toml -o b";
    let ended = place.drape(line).well();
    for pair in ["head-60-1.75-8-mesh-0", "insect-60-1.75-8-mesh-0"] {
        assert!(ended.stdout.contains(pair), "{}", ended.stdout);
        assert!(place.exists(&format!("b/pairs/{pair}/truth.ply")));
        assert!(place.exists(&format!("b/{pair}/short-0.png")));
    }
    assert!(ended.stdout.contains("mean of insect") && ended.stdout.contains("mean of all"));
    let rows: serde_json::Value =
        serde_json::from_str(&place.read("b/bench.json")).expect("the table is JSON");
    for row in rows.as_array().expect("a list of rows") {
        let figure = |name: &str| row[name].as_f64().expect("a figure");
        let gain = figure("truth_initial") / figure("truth");
        assert!((figure("gain") - gain).abs() < 1e-9);
        assert!(figure("crossings") >= 0.0 && figure("q_transfer") > 0.0);
    }
    assert_eq!(place.read("b/bench.csv").lines().count(), 3);
    let again = place.drape(line).well();
    assert!(
        again.stderr.starts_with("4 runs, 4 done before"),
        "{}",
        again.stderr
    );
}

#[test]
fn pairs_of_creatures_are_written_as_files() {
    let place = Workplace::new();
    let line = "bench --plan bird --landmarks 0,20 --seeds 1 --variant mesh,cloud --without tail --write pairs";
    let ended = place.drape(line).well();
    assert!(
        ended.stdout.starts_with("4 pairs written"),
        "{}",
        ended.stdout
    );
    let folder = "pairs/bird-60-1.75-20-cloud-0";
    for name in [
        "source.obj",
        "target.ply",
        "truth.ply",
        "landmarks.json",
        "surface.obj",
    ] {
        assert!(place.exists(&format!("{folder}/{name}")), "{name}");
    }
    assert!(!place
        .read(&format!("{folder}/landmarks.json"))
        .contains("tail tip"));
    assert!(!place.exists("pairs/bird-60-1.75-0-mesh-0/landmarks.json"));
}

#[test]
fn a_bench_with_a_mistake_is_refused_before_any_file_is_written() {
    let place = Workplace::new();
    for (options, word) in [
        ("--angle 150", "--angle"),
        ("--ratio 0.5", "--ratio"),
        ("--landmarks 40", "--landmarks"),
        ("--plan fish", "quadruped"),
        ("--variant wet", "half-scan"),
        ("--preset best", "best"),
    ] {
        let ended = place.drape(&format!("bench {options} -o b"));
        assert_eq!(ended.code, Some(2), "{options}");
        assert!(ended.stderr.contains(word), "{options}: {}", ended.stderr);
    }
    assert!(!place.exists("b"));
    let absent = place.drape("evaluate absent.toml --family creatures -o b");
    assert_eq!(absent.code, Some(2));
    assert!(absent.stderr.contains("absent.toml"), "{}", absent.stderr);
    assert!(!place.exists("b"));
}
