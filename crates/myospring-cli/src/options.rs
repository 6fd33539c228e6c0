//! Options for settings, made from the library's table.

use clap::builder::ValueParser;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches, value_parser};
pub(crate) use myospring::experiment::input::ChosenSetting;
use myospring::experiment::input::is_all_cells;
use myospring::settings::{CommandOption, Setting, Table, Value, ValueKind, tables};
use std::marker::PhantomData;

/// The tables of settings for which a command has options.
pub(crate) trait Scope {
    /// Whether it includes a setting.
    fn has(table: &Table, setting: &Setting) -> bool;
}

/// Settings of the cell's shape and the direction of its fibres.
#[derive(Debug)]
pub(crate) struct Seen;

impl Scope for Seen {
    fn has(table: &Table, setting: &Setting) -> bool {
        let of_fibres = ["mechanics.fibre", "mechanics.stain", "mechanics.fibre_smoothing"];
        is_of_shape(table) || of_fibres.contains(&setting.key)
    }
}

/// Those, and how thick the cell is.
#[derive(Debug)]
pub(crate) struct Meshed;

impl Scope for Meshed {
    fn has(table: &Table, setting: &Setting) -> bool {
        Seen::has(table, setting) || setting.key == "material.thickness"
    }
}

/// Whether a table describes the cell's shape.
fn is_of_shape(table: &Table) -> bool {
    ["shape", "segmentation"].contains(&table.name)
}

/// Settings of a beat: every table.
#[derive(Debug)]
pub(crate) struct Beat;

impl Scope for Beat {
    fn has(_: &Table, _: &Setting) -> bool {
        true
    }
}

/// The settings given by options.
#[derive(Debug)]
pub(crate) struct Settings<S> {
    given: Vec<ChosenSetting>,
    scope: PhantomData<S>,
}

impl<S> Settings<S> {
    /// The value of a key, if its option was given.
    pub(crate) fn get(&self, key: &str) -> Option<&Value> {
        self.given.iter().find(|(setting, _)| setting.key == key).map(|(_, value)| value)
    }

    /// All given settings, including `--cell all`.
    pub(crate) fn given(&self) -> &[ChosenSetting] {
        &self.given
    }

    /// Whether all cells were requested.
    pub(crate) fn all_cells(&self) -> bool {
        self.given.iter().any(is_all_cells)
    }

    /// The settings that override a run file; `--cell all` does not.
    pub(crate) fn overrides(&self) -> Vec<ChosenSetting> {
        self.given.iter().filter(|given| !is_all_cells(given)).cloned().collect()
    }

    /// The cell model among these.
    pub(crate) fn model(&self) -> Vec<ChosenSetting> {
        self.given.iter().filter(|(setting, _)| setting.key == "cell.model").cloned().collect()
    }
}

/// The settings with an option, in the order of the help: shape first.
fn options<S: Scope>() -> impl Iterator<Item = (&'static Table, &'static Setting, CommandOption)> {
    let all = || {
        let rows = |table: &'static Table| table.settings.iter().map(move |row| (table, row));
        tables().iter().flat_map(rows).filter(|(table, row)| S::has(table, row))
    };
    let of_shape = |(table, _): &(&Table, &Setting)| is_of_shape(table);
    all()
        .filter(of_shape)
        .chain(all().filter(move |row| !of_shape(row)))
        .filter_map(|(table, setting)| Some((table, setting, setting.option?)))
}

impl<S: Scope> Args for Settings<S> {
    fn augment_args(command: Command) -> Command {
        options::<S>().fold(command, |command, (table, setting, option)| {
            command.arg(argument(table, setting, option))
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<S: Scope> FromArgMatches for Settings<S> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let given = options::<S>()
            .filter_map(|(_, setting, _)| Some((setting, value(setting, matches)?)))
            .collect();
        Ok(Self { given, scope: PhantomData })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// The option of a setting; its key is the name for clap.
fn argument(table: &Table, setting: &'static Setting, option: CommandOption) -> Arg {
    let argument = Arg::new(setting.key)
        .long(option.name.trim_start_matches('-'))
        .help(help(setting, option))
        .help_heading(table.heading)
        .visible_aliases(option.alias.map(|alias| alias.trim_start_matches('-')));
    let parser = match setting.kind {
        ValueKind::Flag { .. } => return argument.action(ArgAction::SetTrue),
        ValueKind::Whole { .. } => value_parser!(i64).into(),
        _ => ValueParser::string(),
    };
    // Accepts negative values, so that a wrong sign gets the message on its bounds.
    let signed = matches!(
        setting.kind,
        ValueKind::Whole { .. } | ValueKind::Quantity { .. } | ValueKind::Written { .. }
    );
    argument.value_name(option.value).value_parser(parser).allow_hyphen_values(signed)
}

fn value(setting: &Setting, matches: &ArgMatches) -> Option<Value> {
    match setting.kind {
        ValueKind::Flag { .. } => matches.get_flag(setting.key).then_some(Value::Flag(true)),
        ValueKind::Whole { .. } => matches.get_one(setting.key).copied().map(Value::Whole),
        _ => matches.get_one(setting.key).cloned().map(Value::Text),
    }
}

/// The help of a setting: description, words or an example, and default.
fn help(setting: &Setting, option: CommandOption) -> String {
    let about = option.help.unwrap_or(setting.doc.trim_end_matches('.'));
    let names: Vec<&str> = setting.words().iter().map(|word| word.name).collect();
    // Some descriptions explain the words themselves.
    let words = if names.iter().any(|name| about.contains(name)) || names.is_empty() {
        String::new()
    } else {
        format!(": {}", names.join(", "))
    };
    let default = match setting.otherwise {
        Some(otherwise) => Some(otherwise.to_owned()),
        None => match setting.default() {
            // A value with a space is written in quotes.
            Some(Value::Text(text)) if text.is_empty() => None,
            Some(Value::Text(text)) if !text.contains(' ') => Some(text),
            value => value.map(|value| value.to_string()),
        },
    };
    let example = match (setting.kind, setting.example()) {
        (ValueKind::Quantity { .. }, Some(example @ Value::Text(_))) => format!(" ({example})"),
        _ => String::new(),
    };
    match default {
        None => format!("{about}{words}{example}"),
        // A default with its unit is an example, too.
        Some(default) if default.starts_with('"') => format!("{about}{words} [default: {default}]"),
        Some(default) => format!("{about}{words}{example} [default: {default}]"),
    }
}
