//! `tautline interaction --follow`: samples in, torque out, a line each.

use super::outcome::{Talk, complain};
use super::progress;
use crate::evaluate::fitted;
use crate::interaction::{self, Settings, Stream, StreamOutput};
use crate::log::{Campaign, Samples};
use crate::model::Model;
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
    let (model, warnings) = fitted(campaign, model)?;
    let bar = progress::bar(talk, "reading quiet trials", campaign.trials.len());
    let stream = interaction::stream_of(campaign, &model, settings, rate_hz, &|| bar.inc(1));
    bar.finish_and_clear();
    let mut stream = stream?;
    let told = warnings.into_iter().chain(stream.quiet().warnings.iter().cloned());
    complain(&Problems(told.map(|warning| Problem::warning(&campaign.file, warning, "")).collect()));
    if talk.shows_progress() {
        let _ = writeln!(
            anstream::stderr(),
            "following at {} Hz; the torque is {:.3} s late",
            stream.rate_hz(),
            stream.delay_s()
        );
    }
    let output = Rc::new(RefCell::new(BufWriter::new(io::stdout().lock())));
    let input = FlushBeforeRead { input: io::stdin().lock(), output: Rc::clone(&output) };
    match follow(campaign, &mut stream, input, &output, talk.json).and_then(|()| written(output.borrow_mut().flush())) {
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
}

impl Read for FlushBeforeRead {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.output.borrow_mut().flush()?;
        self.input.read(buffer)
    }
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
    for sample in samples {
        let torque = stream.step(&sample.map_err(Stopped::Input)?);
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
