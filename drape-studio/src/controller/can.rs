//! What can be done when: the one answer for the page's controls and for the refusals of the server.

use anyhow::{bail, Result};
use serde::Serialize;
use serde_json::{json, Value};

use super::request::Command;

/// Why nothing can be done without both shapes.
pub(crate) const OPEN_FIRST: &str = "open a source and a target first";
/// Why a shape is not brushed that another one will follow.
const RESUME_FIRST: &str = "resume first: the drape has not taken what was changed";

/// Where a drape stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Status {
    /// The source is being brought to its landmarks, or the drape is taken up again.
    Starting,
    Running,
    Paused,
    /// Ended by the user before its last iteration.
    Stopped,
    /// All iterations are done.
    Finished,
    Failed,
}

/// What cannot be done at all times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Action {
    Command(Command),
    Undo,
    Redo,
    /// To delete all landmarks.
    Clear,
    /// To read landmarks from a file.
    OpenLandmarks,
    /// To brush the result.
    Brush,
    /// To save the result, the warp, the landmarks or the report.
    Export,
}

/// All that decides what can be done.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Situation {
    /// Whether source and target are open.
    pub(crate) has_inputs: bool,
    /// Where the drape stands; none where there is no drape.
    pub(crate) run: Option<Status>,
    /// Whether landmarks or parts changed that the drape has not seen.
    pub(crate) is_pending: bool,
    pub(crate) has_landmarks: bool,
    pub(crate) has_undo: bool,
    pub(crate) has_redo: bool,
}

impl Status {
    /// Whether the drape shows itself.
    pub(crate) fn is_busy(self) -> bool {
        matches!(self, Self::Starting | Self::Running)
    }

    /// Why a command does not fit.
    fn explain(run: Option<Self>) -> &'static str {
        match run {
            None => "there is no drape",
            Some(Self::Starting) => "the drape has not begun yet",
            Some(Self::Running) => "the drape is running",
            Some(Self::Paused) => "the drape is paused",
            Some(Self::Stopped) => "the drape is stopped",
            Some(Self::Finished) => "the drape is finished",
            Some(Self::Failed) => "the drape has failed",
        }
    }
}

impl Action {
    const ALL: [(&'static str, Self); 13] = [
        ("drape", Self::Command(Command::Drape)),
        ("pause", Self::Command(Command::Pause)),
        ("resume", Self::Command(Command::Resume)),
        ("step", Self::Command(Command::Step)),
        ("stop", Self::Command(Command::Stop)),
        ("extend", Self::Command(Command::Extend)),
        ("reset", Self::Command(Command::Reset)),
        ("undo", Self::Undo),
        ("redo", Self::Redo),
        ("clear", Self::Clear),
        ("open_landmarks", Self::OpenLandmarks),
        ("brush", Self::Brush),
        ("export", Self::Export),
    ];
}

impl Situation {
    /// Why an action cannot be done now; none where it can.
    pub(crate) fn refusal(&self, action: Action) -> Option<&'static str> {
        let needs = |holds: bool, else_why: &'static str| (!holds).then_some(else_why);
        match action {
            Action::Undo => needs(self.has_undo, "there is nothing to undo"),
            Action::Redo => needs(self.has_redo, "there is nothing to redo"),
            Action::Clear => needs(self.has_landmarks, "there are no landmarks"),
            Action::OpenLandmarks | Action::Export => needs(self.has_inputs, OPEN_FIRST),
            Action::Brush if self.is_pending => Some(RESUME_FIRST),
            Action::Brush => needs(
                matches!(
                    self.run,
                    Some(Status::Paused | Status::Stopped | Status::Finished)
                ),
                Status::explain(self.run),
            ),
            Action::Command(_) if !self.has_inputs => Some(OPEN_FIRST),
            Action::Command(command) => needs(self.fits(command), Status::explain(self.run)),
        }
    }

    /// Whether a command fits the drape as it is.
    fn fits(&self, command: Command) -> bool {
        use Status::{Failed, Finished, Paused, Running, Starting, Stopped};
        match (command, self.run) {
            (Command::Drape, run) => matches!(run, None | Some(Stopped | Finished | Failed)),
            (Command::Pause, run) => matches!(run, Some(Starting | Running)),
            (Command::Step, None) => true,
            (Command::Resume | Command::Step, Some(Finished)) => self.is_pending,
            (Command::Resume | Command::Step, run) => matches!(run, Some(Paused | Stopped)),
            (Command::Stop, run) => matches!(run, Some(Starting | Running | Paused)),
            (Command::Extend, run) => matches!(run, Some(Stopped | Finished)) && !self.is_pending,
            (Command::Reset, run) => run.is_some(),
        }
    }

    /// Refuses what cannot be done now.
    pub(crate) fn check(&self, action: Action) -> Result<()> {
        match self.refusal(action) {
            Some(why) => bail!(why),
            None => Ok(()),
        }
    }

    /// Whether an action throws a result away; a page asks before.
    fn discards(&self, action: Action) -> bool {
        let has_result = !matches!(self.run, None | Some(Status::Starting | Status::Failed));
        let is_end = matches!(action, Action::Command(Command::Drape | Command::Reset));
        has_result && is_end && self.refusal(action).is_none()
    }

    /// For each action whether it can be done, as pages get it.
    pub(crate) fn can(&self) -> Value {
        let can = |(name, action): &(&str, Action)| {
            ((*name).to_owned(), json!(self.refusal(*action).is_none()))
        };
        Value::Object(Action::ALL.iter().map(can).collect())
    }

    /// The names of the actions that throw a result away.
    pub(crate) fn discarding(&self) -> Vec<&'static str> {
        let all = Action::ALL.iter();
        let discarding = all.filter(|(_, action)| self.discards(*action));
        discarding.map(|(name, _)| *name).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Status::{Failed, Finished, Paused, Running, Starting, Stopped};
    use super::*;

    const STATUSES: [Option<Status>; 7] = [
        None,
        Some(Starting),
        Some(Running),
        Some(Paused),
        Some(Stopped),
        Some(Finished),
        Some(Failed),
    ];

    fn situation(run: Option<Status>, is_pending: bool) -> Situation {
        Situation {
            has_inputs: true,
            run,
            is_pending,
            has_landmarks: true,
            has_undo: true,
            has_redo: true,
        }
    }

    /// The commands that are taken, in the order of their declaration.
    fn commands(situation: &Situation) -> String {
        let taken = Action::ALL.iter().filter(|(_, action)| {
            matches!(action, Action::Command(_)) && situation.refusal(*action).is_none()
        });
        let names: Vec<&str> = taken.map(|(name, _)| *name).collect();
        names.join(" ")
    }

    #[test]
    fn every_command_in_every_state() {
        for run in STATUSES {
            for is_pending in [false, true] {
                let expected = match (run, is_pending) {
                    (None, _) => "drape step",
                    (Some(Starting | Running), _) => "pause stop reset",
                    (Some(Paused), _) => "resume step stop reset",
                    (Some(Stopped), false) => "drape resume step extend reset",
                    (Some(Stopped), true) => "drape resume step reset",
                    (Some(Finished), false) => "drape extend reset",
                    (Some(Finished), true) => "drape resume step reset",
                    (Some(Failed), _) => "drape reset",
                };
                let situation = situation(run, is_pending);
                assert_eq!(commands(&situation), expected, "{run:?} {is_pending}");
            }
        }
    }

    #[test]
    fn nothing_is_driven_without_inputs() {
        for run in STATUSES {
            let situation = Situation {
                has_inputs: false,
                ..situation(run, true)
            };
            assert_eq!(commands(&situation), "");
            for action in [Action::Export, Action::OpenLandmarks] {
                assert_eq!(situation.refusal(action), Some(OPEN_FIRST));
            }
        }
    }

    #[test]
    fn edits_need_what_they_take_back_or_delete() {
        let all = situation(None, false);
        let none = Situation {
            has_landmarks: false,
            has_undo: false,
            has_redo: false,
            ..all
        };
        for action in [Action::Undo, Action::Redo, Action::Clear] {
            assert!(all.check(action).is_ok() && none.check(action).is_err());
        }
    }

    #[test]
    fn what_stands_still_is_brushed() {
        for run in STATUSES {
            let stands = matches!(run, Some(Paused | Stopped | Finished));
            let refusal = situation(run, false).refusal(Action::Brush);
            assert_eq!(refusal.is_none(), stands, "{run:?}");
            assert!(situation(run, true).refusal(Action::Brush).is_some());
        }
    }

    #[test]
    fn what_throws_a_result_away_is_told() {
        for run in STATUSES {
            let expected: &[&str] = match run {
                None | Some(Starting | Failed) => &[],
                Some(Running | Paused) => &["reset"],
                Some(Stopped | Finished) => &["drape", "reset"],
            };
            assert_eq!(situation(run, false).discarding(), expected, "{run:?}");
        }
    }

    #[test]
    fn pages_are_told_of_every_action() {
        let can = situation(Some(Paused), false).can();
        assert_eq!(can.as_object().map(serde_json::Map::len), Some(13));
        assert_eq!(
            (&can["resume"], &can["pause"]),
            (&json!(true), &json!(false))
        );
    }
}
