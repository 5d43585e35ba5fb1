//! What keys do. One table: the window acts by it, and the cheat sheet lists it.

use super::navigate::Axis;
use egui::{Key, Modifiers};

/// Something that a person can ask for with a key or a button.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Action {
    Open,
    SavePng,
    SaveExr,
    CopyCommand,
    DumpCamera,
    Reload,
    Restart,
    Pause,
    Step,
    ResetCamera,
    FrameAll,
    Look(Axis),
    NextCamera,
    Hud,
    Help,
    Hemisphere,
    HalveSpp,
    DoubleSpp,
    HalveLightSamples,
    DoubleLightSamples,
    FewerBounces,
    MoreBounces,
    OnlyBounce,
    SmallerLens,
    LargerLens,
    NearerFocus,
    FartherFocus,
    Crop,
    NextView,
    NextToneCurve,
    Darker,
    Brighter,
    NoExposure,
    Tree,
    TreeLeft,
    TreeRight,
    TreeUp,
    TreeRay,
    Escape,
    Quit,
}

/// A key and what it does.
pub(super) struct Binding {
    pub(super) modifiers: Modifiers,
    pub(super) key: Key,
    pub(super) action: Action,
}

const NONE: Modifiers = Modifiers::NONE;
const SHIFT: Modifiers = Modifiers::SHIFT;
const CTRL: Modifiers = Modifiers::COMMAND;

macro_rules! bindings {
    ($($modifiers:ident $key:ident $action:expr),* $(,)?) => {
        &[$(Binding { modifiers: $modifiers, key: Key::$key, action: $action }),*]
    };
}

/// All keys, those of the tree apart.
pub(super) const BINDINGS: &[Binding] = bindings![
    CTRL O Action::Open,
    CTRL Q Action::Quit,
    NONE S Action::SavePng,
    NONE F12 Action::SavePng,
    SHIFT S Action::SaveExr,
    CTRL C Action::CopyCommand,
    NONE D Action::DumpCamera,
    NONE F5 Action::Reload,
    NONE R Action::Restart,
    NONE P Action::Pause,
    NONE E Action::Pause,
    NONE N Action::Step,
    NONE Space Action::ResetCamera,
    NONE F Action::FrameAll,
    NONE Num1 Action::Look(Axis::Front),
    NONE Num3 Action::Look(Axis::Right),
    NONE Num7 Action::Look(Axis::Top),
    SHIFT Num1 Action::Look(Axis::Back),
    SHIFT Num3 Action::Look(Axis::Left),
    SHIFT Num7 Action::Look(Axis::Bottom),
    NONE Num0 Action::NextCamera,
    NONE Tab Action::Hud,
    NONE F1 Action::Help,
    SHIFT Slash Action::Help,
    NONE Questionmark Action::Help,
    SHIFT Questionmark Action::Help,
    NONE H Action::Hemisphere,
    NONE OpenBracket Action::HalveSpp,
    NONE CloseBracket Action::DoubleSpp,
    NONE Minus Action::HalveLightSamples,
    NONE Plus Action::DoubleLightSamples,
    SHIFT Plus Action::DoubleLightSamples,
    SHIFT Equals Action::DoubleLightSamples,
    NONE Equals Action::DoubleLightSamples,
    SHIFT Comma Action::FewerBounces,
    SHIFT Period Action::MoreBounces,
    NONE Comma Action::FewerBounces,
    NONE Period Action::MoreBounces,
    NONE O Action::OnlyBounce,
    NONE K Action::SmallerLens,
    NONE L Action::LargerLens,
    NONE Semicolon Action::NearerFocus,
    NONE Quote Action::FartherFocus,
    NONE C Action::Crop,
    NONE G Action::NextView,
    NONE T Action::NextToneCurve,
    NONE PageDown Action::Darker,
    NONE PageUp Action::Brighter,
    NONE Home Action::NoExposure,
    NONE V Action::Tree,
    NONE Escape Action::Escape,
];

/// Keys while the tree is shown; the others go on working.
pub(super) const TREE_BINDINGS: &[Binding] = &[
    Binding { modifiers: NONE, key: Key::ArrowLeft, action: Action::TreeLeft },
    Binding { modifiers: NONE, key: Key::ArrowRight, action: Action::TreeRight },
    Binding { modifiers: NONE, key: Key::ArrowUp, action: Action::TreeUp },
    Binding { modifiers: NONE, key: Key::A, action: Action::TreeRay },
];

/// What a pressed key asks for.
pub(super) fn action(key: Key, modifiers: Modifiers, is_tree_shown: bool) -> Option<Action> {
    let fits = |b: &&Binding| b.key == key && modifiers.matches_exact(b.modifiers);
    let in_tree = TREE_BINDINGS.iter().filter(|_| is_tree_shown).find(fits);
    in_tree.or_else(|| BINDINGS.iter().find(fits)).map(|b| b.action)
}

/// The cheat sheet: heading, then keys and what they do.
pub(super) const CHEAT_SHEET: &[(&str, &[(&str, &str)])] = &[
    (
        "Camera",
        &[
            ("drag", "orbit the pivot"),
            ("middle drag, Shift drag", "pan"),
            ("wheel", "dolly to the cursor"),
            ("right drag, W A S D Q E", "fly; Shift fast"),
            ("double click", "pivot and focus there"),
            ("Space", "back to the file's camera"),
            ("0", "next camera of the file"),
            ("F", "frame all"),
            ("1 3 7, with Shift", "front, right, top; from behind"),
            ("K L", "smaller, larger lens"),
            ("; '", "nearer, farther focus"),
            ("D", "copy the camera as JSON"),
        ],
    ),
    (
        "Light",
        &[
            ("H", "uniform hemisphere sampling on and off"),
            ("[ ]", "half, double the samples"),
            ("- +", "half, double the light samples"),
            ("< >", "fewer, more bounces"),
            ("O", "only the last bounce"),
            ("Shift right drag", "turn the environment"),
        ],
    ),
    (
        "Picture",
        &[
            ("R", "restart"),
            ("P or E", "pause"),
            ("N", "one step"),
            ("C, then drag", "render only a part; Esc the whole"),
            ("G", "next view"),
            ("T", "next tone curve"),
            ("PgUp PgDn Home", "brighter, darker, as it is"),
            ("S or F12, Shift S", "save PNG, save EXR"),
            ("Ctrl C", "copy the render command"),
        ],
    ),
    (
        "Tree and window",
        &[
            ("V", "boxes of the tree"),
            ("← → ↑", "left child, right child, parent"),
            ("A", "the ray of the last double click"),
            ("Ctrl O, F5", "open, reload"),
            ("Tab", "panel on and off"),
            ("F1 or ?", "this sheet"),
            ("Ctrl Q", "quit"),
        ],
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_does_two_things() {
        for list in [BINDINGS, TREE_BINDINGS] {
            for (i, a) in list.iter().enumerate() {
                for b in &list[..i] {
                    assert!(a.key != b.key || a.modifiers != b.modifiers, "{:?}", a.key);
                }
            }
        }
    }

    #[test]
    fn arrows_walk_the_tree_only_while_it_is_shown() {
        assert_eq!(action(Key::ArrowLeft, NONE, false), None);
        assert_eq!(action(Key::ArrowLeft, NONE, true), Some(Action::TreeLeft));
        assert_eq!(action(Key::S, NONE, true), Some(Action::SavePng));
        assert_eq!(action(Key::S, SHIFT, false), Some(Action::SaveExr));
        assert_eq!(action(Key::S, CTRL, false), None);
    }
}
