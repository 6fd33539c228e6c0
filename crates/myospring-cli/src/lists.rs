//! `myospring models`, `init` and `schema`.

mod model_files;

use crate::args::{InitArgs, LIST, ModelsArgs, SchemaArgs, SchemaOf};
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::print;
use crate::table::aligned;
use myospring::cell::{self, CellModel};
use myospring::cell_files;
use myospring::output::json;
use myospring::parameter::ParameterSet;
use myospring::run_file::{self, PRESETS};
use myospring::study::parameters;
use serde::Serialize;
use std::fs;
use std::path::Path;

#[derive(Serialize)]
struct Model<'a> {
    name: &'a str,
    description: &'a str,
    citations: Vec<&'a str>,
    state: Vec<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    parameters: Option<&'a ParameterSet>,
}

impl<'a> Model<'a> {
    fn of(model: &'a dyn CellModel, parameters: bool) -> Self {
        Self {
            name: model.name(),
            description: model.description(),
            citations: model.citations(),
            state: model.state_names(),
            parameters: parameters.then(|| model.parameters()),
        }
    }
}

pub(crate) fn models(args: &ModelsArgs) -> Result<ExitCode, Failure> {
    if let Some(name) = args.name.as_ref().filter(|name| cell_files::is_model_file(name)) {
        print::out(&model_files::text(args, name)?)?;
        return Ok(ExitCode::SUCCESS);
    }
    if let Some(name) = &args.name {
        let model = cell::model(name).map_err(Failure::new)?;
        let text = if args.check {
            model_files::checked(&*model)?
        } else if args.rates {
            model_files::rates_of(&*model)?
        } else if args.json {
            json::pretty(&Model::of(&*model, true))?
        } else {
            of_parameters(&*model)
        };
        print::out(&text)?;
        return Ok(ExitCode::SUCCESS);
    }
    let models = cell::models();
    if args.json {
        let list: Vec<Model<'_>> = models.iter().map(|model| Model::of(&**model, false)).collect();
        print::out(&json::pretty(&list)?)?;
    } else {
        let rows: Vec<Vec<String>> = models
            .iter()
            .map(|model| vec![model.name().to_owned(), model.description().to_owned()])
            .collect();
        print::out(&aligned(&rows, &[]))?;
        print::out("\n`myospring models NAME` shows the parameters of one")?;
    }
    Ok(ExitCode::SUCCESS)
}

fn of_parameters(model: &dyn CellModel) -> String {
    let header = ["parameter", "value", "unit", "range", "meaning", "source"];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    for row in model.parameters().rows() {
        rows.push(vec![
            row.name.to_string(),
            row.value.to_string(),
            row.unit.to_string(),
            format!("{} to {}", row.minimum, row.maximum),
            row.meaning.to_string(),
            row.source.to_string(),
        ]);
    }
    let (name, about) = (model.name(), model.description());
    let state = model.state_names().join(", ");
    let papers = model.citations().join(", ");
    format!("{name}: {about}\nstate: {state}\npapers: {papers}\n\n{}", aligned(&rows, &[1]))
}

pub(crate) fn init(args: &InitArgs) -> Result<ExitCode, Failure> {
    if args.preset.as_deref() == Some(LIST) {
        let rows: Vec<_> = PRESETS
            .iter()
            .map(|preset| [preset.name, preset.about].map(str::to_owned).to_vec())
            .collect();
        print::out(&aligned(&rows, &[]))?;
        return Ok(ExitCode::SUCCESS);
    }
    let chosen = PRESETS.iter().find(|preset| args.preset.as_deref() == Some(preset.name));
    let text = chosen.map_or_else(run_file::template, |preset| preset.text.to_owned());
    let Some(path) = &args.file else {
        print::out(&text)?;
        return Ok(ExitCode::SUCCESS);
    };
    if path.exists() && !args.force {
        let message = format!("`{}` exists already", path.display());
        return Err(Failure::new(message).advise("give another name, or replace it with --force"));
    }
    write_with_schema(path, &text, SchemaOf::Run)?;
    print::note(&format!("wrote {0}; try: myospring run {0} --dry-run", path.display()));
    Ok(ExitCode::SUCCESS)
}

pub(crate) fn schema(args: &SchemaArgs) -> Result<ExitCode, Failure> {
    print::out(&json::pretty(&args.of.schema())?)?;
    Ok(ExitCode::SUCCESS)
}

impl SchemaOf {
    fn schema(self) -> serde_json::Value {
        match self {
            Self::Run => run_file::schema(),
            Self::Study => parameters::schema(),
        }
    }

    /// The name of the schema's file.
    const fn file(self) -> &'static str {
        match self {
            Self::Run => "myospring-run.schema.json",
            Self::Study => "myospring-study.schema.json",
        }
    }
}

/// Writes a text with a first line by which editors find its schema, and the schema next to it;
/// another file of the schema's name is not replaced.
pub(crate) fn write_with_schema(path: &Path, text: &str, of: SchemaOf) -> Result<(), Failure> {
    FILES.write(path, format!("#:schema {}\n{text}", of.file()))?;
    let beside = path.with_file_name(of.file());
    let is_ours = |there: String| there.contains("\"urn:myospring:");
    if fs::read_to_string(&beside).map_or(!beside.exists(), is_ours) {
        FILES.write(&beside, json::pretty(&of.schema())?)?;
    }
    Ok(())
}
