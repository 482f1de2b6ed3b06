//! An interaction as `interaction.json`, tables, on the terminal, and as a page.

use super::number::{count, counted, significant};
use super::page::{Block, Card, Page, Section, Table, Warning, cells};
use super::plots;
use super::terminal::{BOLD, DIM, heading, table as write_table, wrapped, write_warnings};
use super::wording::Units;
use crate::interaction::{Comparison, Contact, Interaction, Quiet, TrialInteraction};
use crate::log::table::{Numbers, csv_bytes};
use serde_json::{Value, json};
use std::io::{self, Write};
use std::path::Path;

/// `found` by the model in the file called `model`, on the campaign called `campaign`; what is not known is null.
pub fn to_json(found: &Interaction, campaign: &str, model: &str) -> Value {
    let quiet = &found.quiet;
    let rates = quiet.false_alarms_per_hour();
    json!({
        "format": "interaction/1",
        "frame": found.settings.frame.name(),
        "causal": found.settings.causal,
        "filter_delay_s": found.filter_delay_s,
        "lowpass_hz": found.lowpass_hz,
        "threshold_nm": quiet.levels.stable_nm,
        "threshold_at_reversals_nm": quiet.levels.weak_nm,
        "uncertainty_nm": quiet.levels.stable_within_nm,
        "uncertainty_at_reversals_nm": quiet.levels.weak_within_nm,
        "quiet": {
            "trials": quiet.trials,
            "seconds": quiet.quiet_s,
            "rmse_nm": quiet.rmse_nm,
            "false_alarms": quiet.false_alarms,
            "false_alarm_rate_per_hour": rates.map(|r| r.0),
            "false_alarm_rate_at_most_per_hour": rates.map(|r| r.1),
        },
        "trials": found.trials.iter().map(|t| trial(t, quiet)).collect::<Vec<Value>>(),
        "warnings": found.warnings,
        "provenance": { "tautline": env!("CARGO_PKG_VERSION"), "campaign": campaign, "model": model },
    })
}

fn trial(trial: &TrialInteraction, quiet: &Quiet) -> Value {
    let compared = trial.comparison.as_ref();
    let figure = |of: fn(&Comparison) -> f64| compared.map(of);
    json!({
        "file": trial.entry.file,
        "rmse_nm": figure(|c| c.error.rmse_nm),
        "mae_nm": figure(|c| c.error.mae_nm),
        "rmse_percent": figure(|c| c.error.rmse_percent),
        "mae_percent": figure(|c| c.error.mae_percent),
        "max_error_nm": figure(|c| c.error.peak_nm),
        "peak_error_nm": figure(|c| c.peak_error_nm),
        "delay_s": figure(|c| c.delay_s),
        "onset_delay_s": figure(|c| c.onset_delay_s),
        "slope": figure(|c| c.slope),
        "reference_contacts": compared.map(|c| c.contacts),
        "missed": compared.map(|c| c.missed),
        "spurious": compared.map(|c| c.spurious),
        "samples": trial.extracted.known.iter().filter(|known| **known).count(),
        "onset_threshold_nm": quiet.levels.stable_nm,
        "false_alarm_rate_per_hour": quiet.false_alarms_per_hour().map(|r| r.0),
        "contacts": trial.contacts.iter().map(contact).collect::<Vec<Value>>(),
    })
}

fn contact(contact: &Contact) -> Value {
    json!({
        "onset_s": contact.onset_s,
        "release_s": contact.release_s,
        "peak_nm": contact.peak_nm,
        "at_reversal": contact.at_reversal,
    })
}

/// The table of one trial, sample by sample.
pub fn trial_csv(trial: &TrialInteraction, quiet: &Quiet) -> Vec<u8> {
    let extracted = &trial.extracted;
    let n = extracted.torque_nm.len();
    let at = |i: usize| (extracted.weak[i], extracted.known[i], extracted.change_nm[i]);
    let of = |level: &dyn Fn((bool, bool, f64)) -> f64| (0..n).map(|i| level(at(i))).collect::<Vec<f64>>();
    let uncertainty_nm = of(&|(weak, known, change)| quiet.levels.uncertainty(weak, known, change));
    let threshold_nm = of(&|(weak, known, change)| quiet.levels.threshold(weak, known, change));
    let known = of(&|(_, known, _)| f64::from(u8::from(known)));
    let mut touched = vec![0.0; n];
    for contact in &trial.contacts {
        let inside = |t: &f64| (contact.onset_s..=contact.release_s).contains(t);
        touched.iter_mut().zip(&extracted.time_s).filter(|(_, t)| inside(t)).for_each(|(slot, _)| *slot = 1.0);
    }
    // Enough for a stream to be compared with.
    let torque = |name, values| Numbers { name, values, decimals: 14 };
    let mut columns = vec![
        Numbers { name: "time_s", values: &extracted.time_s, decimals: 6 },
        torque("interaction_nm", &extracted.torque_nm),
        torque("uncertainty_nm", &uncertainty_nm),
        torque("threshold_nm", &threshold_nm),
        Numbers { name: "contact", values: &touched, decimals: 0 },
        Numbers { name: "known", values: &known, decimals: 0 },
    ];
    columns.extend(extracted.reference_nm.as_ref().map(|values| torque("reference_nm", values)));
    csv_bytes(&columns)
}

fn threshold_sentence(found: &Interaction, units: &Units) -> String {
    let quiet = &found.quiet;
    let levels = format!(
        "A contact is a torque beyond {} in stable state, {} around reversals",
        units.torque(quiet.levels.stable_nm),
        units.torque(quiet.levels.weak_nm)
    );
    match quiet.false_alarms_per_hour() {
        Some((rate, most)) => format!(
            "{levels}; on {} s of quiet motion that gave {} ({} an hour, at most {}).",
            significant(quiet.quiet_s, 3),
            counted(quiet.false_alarms.unwrap_or(0), "false alarm", "false alarms"),
            significant(rate, 2),
            significant(most, 2)
        ),
        None => format!("{levels}; the false-alarm rate is unknown, because there are no quiet trials."),
    }
}

fn agreement_sentence(found: &Interaction, units: &Units) -> Option<String> {
    let compared: Vec<&Comparison> = found.trials.iter().filter_map(|t| t.comparison.as_ref()).collect();
    let pooled = crate::evaluate::pooled(&compared.iter().map(|c| c.error).collect::<Vec<_>>());
    let own = found
        .quiet
        .rmse_nm
        .map_or(String::new(), |rmse| format!("; RMSE of the model on quiet motion: {}", units.torque(rmse)));
    (!compared.is_empty()).then(|| {
        format!(
            "Against the torque measured independently: RMSE {}, MAE {} over {}{own}.",
            units.torque(pooled.rmse_nm),
            units.torque(pooled.mae_nm),
            counted(compared.len(), "trial", "trials")
        )
    })
}

/// What to do next, a sentence each.
fn next(found: &Interaction) -> Vec<String> {
    let mut steps = Vec::new();
    if found.quiet.false_alarms_per_hour().is_none() {
        let step =
            "Record trials in which nobody touches the joint: they give the thresholds and the false-alarm rate.";
        steps.push(step.to_string());
    }
    let weaker = "To detect weaker contacts, reduce the residual on quiet motion: tautline diagnose ranks its causes.";
    let live = "For the torque while it is recorded: tautline interaction CAMPAIGN --model MODEL --follow reads samples as they come.";
    steps.extend([weaker, live].map(str::to_string));
    steps
}

/// The page of `found`.
pub fn page(found: &Interaction, campaign: &str, model: &str) -> Page {
    let units = Units::of(&found.model.joint);
    let contacts: usize = found.trials.iter().map(|t| t.contacts.len()).sum();
    let card = |name: &str, value: String, note: &str| Card { name: name.into(), value, note: note.into() };
    let mut steps = vec![threshold_sentence(found, &units)];
    steps.extend(agreement_sentence(found, &units));
    let trials = plots::interaction::figures(found).into_iter().map(|(name, figure)| (name, vec![figure])).collect();
    Page {
        kicker: format!("tautline interaction · campaign {campaign} · model {model}"),
        title: found.model.joint.name.clone(),
        subject: "interaction".to_string(),
        short: format!(
            "{} in {}; torques are at the {}{}.",
            counted(contacts, "contact", "contacts"),
            counted(found.trials.len(), "trial", "trials"),
            found.settings.frame.name(),
            if found.settings.causal {
                format!(", {} s late", significant(found.filter_delay_s, 2))
            } else {
                String::new()
            }
        ),
        next: next(found),
        warnings: found.warnings.iter().map(Warning::from).collect(),
        cards: vec![
            card("contacts", count(contacts), "longer than half a period of the low-pass"),
            card("threshold", units.torque(found.quiet.levels.stable_nm), "stable state"),
            card("threshold", units.torque(found.quiet.levels.weak_nm), "around reversals"),
            card(
                "uncertainty",
                units.torque(found.quiet.levels.stable_within_nm),
                "95 % of quiet samples, stable state",
            ),
        ],
        sections: vec![
            Section::open("Torque over time", vec![Block::List(steps), Block::Choice("trial", trials)]),
            Section::open("By trial", vec![Block::Table(trials_table(found, &units))]),
            Section::folded("Contacts", vec![Block::Table(contacts_table(found, &units))]),
        ],
        provenance: vec![
            ("campaign", campaign.to_string()),
            ("model", model.to_string()),
            ("quiet trials", count(found.quiet.trials)),
            (
                "low-pass",
                format!(
                    "{} Hz, {}",
                    significant(found.lowpass_hz, 3),
                    if found.settings.causal { "forwards only" } else { "zero phase" }
                ),
            ),
        ],
        ..Page::default()
    }
}

fn trials_table(found: &Interaction, units: &Units) -> Table {
    let row = |t: &TrialInteraction| {
        let figure =
            |of: fn(&Comparison) -> f64| t.comparison.as_ref().map_or("–".to_string(), |c| units.torque(of(c)));
        let time =
            |of: fn(&Comparison) -> f64| t.comparison.as_ref().map_or("–".to_string(), |c| milliseconds(of(c)));
        let missed = t.comparison.as_ref().map_or("–".to_string(), |c| format!("{} / {}", c.missed, c.spurious));
        vec![
            t.entry.file.clone(),
            count(t.contacts.len()),
            figure(|c| c.error.rmse_nm),
            figure(|c| c.error.mae_nm),
            figure(|c| c.peak_error_nm),
            time(|c| c.delay_s),
            time(|c| c.onset_delay_s),
            missed,
        ]
    };
    let heads =
        ["trial", "contacts", "RMSE", "MAE", "peak error", "delay (ms)", "onset delay (ms)", "missed / spurious"];
    Table {
        title: String::new(),
        intro: "Against the torque measured independently, where there is one, through the same low-pass. The peak error is the \
                difference of the peaks of each contact, averaged; the delay is where the two correlate best, the reference being filtered as late as the torque."
            .to_string(),
        heads: heads.map(String::from).to_vec(),
        rows: found.trials.iter().map(row).map(cells).collect(),
    }
}

fn contacts_table(found: &Interaction, units: &Units) -> Table {
    let row = |file: &str, c: &Contact| {
        vec![
            file.to_string(),
            significant(c.onset_s, 5),
            significant(c.release_s, 5),
            units.torque(c.peak_nm),
            if c.at_reversal { "begins at a reversal" } else { "" }.to_string(),
        ]
    };
    let rows = found.trials.iter().flat_map(|t| t.contacts.iter().map(move |c| (t, c)));
    Table {
        title: String::new(),
        intro: "Onset and release as the torque crosses the threshold, and the largest torque between.".to_string(),
        heads: ["trial", "onset (s)", "release (s)", "peak", ""].map(String::from).to_vec(),
        rows: rows.map(|(t, c)| cells(row(&t.entry.file, c))).collect(),
    }
}

/// Writes the summary to `out`; `written` is where the files went.
pub fn write_summary(out: &mut impl Write, found: &Interaction, campaign: &str, written: &Path) -> io::Result<()> {
    let units = Units::of(&found.model.joint);
    let trials = counted(found.trials.len(), "trial", "trials");
    writeln!(
        out,
        "{BOLD}{}{BOLD:#}  {DIM}interaction in {trials} of campaign {campaign}{DIM:#}",
        found.model.joint.name
    )?;
    heading(out, "Trials")?;
    let table = trials_table(found, &units);
    write_table(out, &table.heads, &table.texts())?;
    writeln!(out, "\n  {}", wrapped(&threshold_sentence(found, &units), 2))?;
    if let Some(sentence) = agreement_sentence(found, &units) {
        writeln!(out, "  {}", wrapped(&sentence, 2))?;
    }
    if found.settings.causal {
        writeln!(
            out,
            "  Filtered forwards only, torque and reference are {} s late.",
            significant(found.filter_delay_s, 2)
        )?;
    }
    write_warnings(out, &found.warnings)?;
    writeln!(
        out,
        "\nwritten to {BOLD}{}{BOLD:#}: interaction.json, a table per trial, report.html, plots",
        written.display()
    )
}

/// To a tenth of a millisecond: what lies below is rounding.
fn milliseconds(time_s: f64) -> String {
    if time_s.is_finite() { format!("{:.1}", 1e3 * time_s) } else { "–".to_string() }
}
