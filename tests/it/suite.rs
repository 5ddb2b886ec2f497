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
    assert_eq!(ended.code, Some(1));
    assert!(place.exists("done/source-target.obj") && place.exists("done/source-second.obj"));
    assert!(!place.exists("done/source-third.obj"));
    assert!(place.exists("drape-batch/index.html"));

    let clash = place.drape("batch source.obj target.ply second.ply -o one.obj");
    assert_eq!((clash.code, clash.stderr.lines().count()), (Some(2), 1));
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
