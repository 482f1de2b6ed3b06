//! `tautline interaction --follow`: samples in, torque out, a line each.

use super::outcome::{Talk, complain};
use super::progress;
use crate::evaluate::fitted;
use crate::interaction::{self, Settings, Stream, StreamOutput};
use crate::log::{Campaign, Samples};
use crate::model::Model;
use crate::numerics::statistics::quantile;
use crate::problem::{Problem, Problems, Result};
use serde_json::json;
use std::cell::RefCell;
use std::io::{self, BufWriter, Read, StdinLock, StdoutLock, Write};
use std::process::ExitCode;
use std::rc::Rc;

/// Follows standard input until it ends.
///
/// Errors: the quiet trials or a line of the input cannot be read; what was written until then stands.
pub fn run(
    campaign: &Campaign,
    model: &Model,
    settings: Settings,
    rate_hz: Option<f64>,
    talk: &Talk,
) -> Result<ExitCode> {
    let (campaign, model, warnings) = fitted(campaign, model)?;
    let campaign = campaign.as_ref();
    let bar = progress::bar(talk, "reading quiet trials", campaign.trials.len());
    let stream = interaction::stream_of(campaign, &model, settings, rate_hz, &|| bar.inc(1));
    bar.finish_and_clear();
    let mut stream = stream?;
    let told = warnings.into_iter().chain(stream.quiet().warnings.iter().cloned());
    complain(&Problems(told.map(|warning| Problem::warning(&campaign.file, warning, "")).collect()));
    if talk.shows_progress() {
        let (hz, torque_s, contact_s) = (stream.rate_hz(), stream.delay_s(), stream.contact_delay_s());
        let told = format!(
            "following at {hz:.1} Hz: the torque is {torque_s:.3} s late, a contact is told {contact_s:.3} s late"
        );
        let _ = writeln!(anstream::stderr(), "{told}");
    }
    let output = Rc::new(RefCell::new(BufWriter::new(io::stdout().lock())));
    let lost = Rc::new(RefCell::new(None));
    let input = FlushBeforeRead { input: io::stdin().lock(), output: Rc::clone(&output), lost: Rc::clone(&lost) };
    let followed = follow(campaign, &mut stream, input, &output, talk.json);
    let followed = match lost.take() {
        Some(error) => Err(Stopped::Output(error)),
        None => followed.and_then(|()| written(output.borrow_mut().flush())),
    };
    match followed {
        Err(Stopped::Input(problems)) => Err(problems),
        // A reader that went away is no failure of ours.
        Err(Stopped::Output(error)) if error.kind() != io::ErrorKind::BrokenPipe => {
            Problem::error("standard output", format!("cannot be written: {error}"), "make room").alone()
        }
        _ => {
            if stream.gaps > 0 {
                let what = format!("gaps: {}; the filters started anew after each", stream.gaps);
                complain(&Problem::warning("standard input", what, "").into());
            }
            if stream.left_out > 0 {
                let what =
                    format!("samples left out, beyond what this joint and its sensors show: {}", stream.left_out);
                complain(&Problem::warning("standard input", what, "check the sensors and their cables").into());
            }
            Ok(ExitCode::SUCCESS)
        }
    }
}

/// Why following ended early.
enum Stopped {
    Input(Problems),
    Output(io::Error),
}

fn written(result: io::Result<()>) -> std::result::Result<(), Stopped> {
    result.map_err(Stopped::Output)
}

type Shared = Rc<RefCell<BufWriter<StdoutLock<'static>>>>;

/// Standard input that first hands over what is written, so that no answer waits for the next sample.
struct FlushBeforeRead {
    input: StdinLock<'static>,
    output: Shared,
    /// What went wrong with the output, which the reader must not take for a fault of the input.
    lost: Rc<RefCell<Option<io::Error>>>,
}

impl Read for FlushBeforeRead {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self.output.borrow_mut().flush() {
            Ok(()) => self.input.read(buffer),
            Err(error) => {
                *self.lost.borrow_mut() = Some(error);
                Ok(0)
            }
        }
    }
}

/// Samples from which the stream's rate is judged ...
const RATE_SAMPLES: usize = 50;
/// ... and by how much it may differ from the one expected.
const RATE_TOLERANCE: f64 = 0.05;

/// Errors, once there are enough `times_s`: samples come at another rate than the filters are made for.
fn check_rate(times_s: &[f64], rate_hz: f64) -> Result<()> {
    let mut periods_s: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let found_hz = 1.0 / quantile(&mut periods_s, 0.5);
    if times_s.len() < RATE_SAMPLES || (found_hz / rate_hz - 1.0).abs() <= RATE_TOLERANCE {
        return Ok(());
    }
    let what = format!("samples come at {found_hz:.4} Hz, {rate_hz:.4} Hz are expected");
    Problem::error("standard input", what, format!("start with --rate-hz {found_hz:.4}")).alone()
}

fn follow(
    campaign: &Campaign,
    stream: &mut Stream,
    input: FlushBeforeRead,
    output: &Shared,
    json: bool,
) -> std::result::Result<(), Stopped> {
    let samples = Samples::new(campaign, input).map_err(Stopped::Input)?;
    if !json {
        let header = "time_s,interaction_nm,uncertainty_nm,threshold_nm,contact,known";
        written(writeln!(output.borrow_mut(), "{header}"))?;
    }
    let mut times_s = Vec::with_capacity(RATE_SAMPLES);
    // The header is row 1.
    for (row, sample) in (2..).zip(samples) {
        let sample = sample.map_err(Stopped::Input)?;
        if times_s.len() < RATE_SAMPLES {
            times_s.push(sample.time_s);
            check_rate(&times_s, stream.rate_hz()).map_err(Stopped::Input)?;
        }
        let (gaps, fault) = (stream.gaps, stream.fault(&sample));
        let torque = stream.step(&sample);
        if let Some((name, value)) = fault.filter(|_| stream.left_out == 1) {
            let what =
                format!("{name} {value:e} is beyond what this joint and its sensors show: the sample is left out");
            let cure = "its torque is held and `known` is 0 until the filters have forgotten it; the others like it are counted at the end";
            complain(&Problem::warning("standard input", what, cure).at_row(row).into());
        }
        if !(torque.torque_nm.is_finite() && torque.uncertainty_nm.is_finite() && torque.threshold_nm.is_finite()) {
            let what = "the interaction torque is not a number, because of a numerical overflow in the model";
            let cure = "check the model's parameters for values that no joint has";
            return Err(Stopped::Input(Problem::error("standard input", what, cure).at_row(row).into()));
        }
        if gaps == 0 && stream.gaps == 1 {
            let what =
                format!("a gap before {} s: the filters start anew, and K_f is not known again yet", sample.time_s);
            complain(&Problem::warning("standard input", what, "").into());
        }
        written(write_line(&mut *output.borrow_mut(), &torque, json))?;
    }
    Ok(())
}

fn write_line(out: &mut impl Write, torque: &StreamOutput, json: bool) -> io::Result<()> {
    let StreamOutput { time_s, torque_nm, uncertainty_nm, threshold_nm, contact, known } = *torque;
    if json {
        let line = json!({
            "time_s": time_s, "interaction_nm": torque_nm, "uncertainty_nm": uncertainty_nm,
            "threshold_nm": threshold_nm, "contact": contact, "known": known,
        });
        return writeln!(out, "{line}");
    }
    let (contact, known) = (u8::from(contact), u8::from(known));
    writeln!(out, "{time_s:?},{torque_nm:?},{uncertainty_nm:.6},{threshold_nm:.6},{contact},{known}")
}
