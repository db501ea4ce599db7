//! Assembles the page from its HTML, style and script, and inserts the data of the form.

use super::Form;
use super::encode::{data_url, wav_16};
use crate::experiment::localise::answers::{FORMAT, MOST_CONFIDENT, VERSION};
use crate::text::json_in_html;
use serde_json::{Value, json};
use std::io;

const PAGE: &str = include_str!("form.html");
const STYLE: &str = include_str!("form.css");
const PROGRAM: &str = concat!(include_str!("form_data.js"), include_str!("form.js"));

/// The whole page.
pub fn html(form: &Form) -> io::Result<String> {
    let data = json_in_html(&data(form)?.to_string());
    let page = PAGE
        .replace("/*STYLE*/", STYLE)
        .replace("/*PROGRAM*/", PROGRAM)
        .replace("/*DATA*/", &data);
    Ok(page)
}

fn data(form: &Form) -> io::Result<Value> {
    let plans = form.plans.iter().map(|plan| {
        json!({
            "min": [plan.min.x, plan.min.y],
            "max": [plan.max.x, plan.max.y],
            "radius": plan.radius,
            "plan": data_url("image/png", &plan.plan_png),
            "view": data_url("image/png", &plan.view_png),
        })
    });
    let trials = form.trials.iter().map(|trial| {
        let audio = match form.embedded {
            true => data_url("audio/wav", &wav_16(&form.samples(trial))?),
            false => trial.file.clone(),
        };
        Ok(json!({
            "number": trial.number,
            "stimulus": trial.stimulus,
            "plan": trial.plan,
            "audio": audio,
        }))
    });
    Ok(json!({
        "format": FORMAT,
        "version": VERSION,
        "experiment": form.experiment,
        "seed": form.seed,
        "orderSeed": form.order_seed,
        "mostConfident": MOST_CONFIDENT,
        "plans": plans.collect::<Vec<_>>(),
        "trials": trials.collect::<io::Result<Vec<Value>>>()?,
    }))
}
