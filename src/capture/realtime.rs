//! What the operating system grants to a thread that must not be late.

/// Priority among real-time threads, of 1 to 99: above ordinary work, below the kernel's own interrupt threads (50).
const PRIORITY: i32 = 49;

/// Asks for memory that stays in place and for scheduling before all ordinary work; says of each whether it was granted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Granted {
    /// Why memory is not locked, where it is not.
    pub memory: Result<(), String>,
    /// Why this thread is scheduled as any other, where it is.
    pub scheduling: Result<(), String>,
}

impl Granted {
    /// Asks for the calling thread.
    #[cfg(target_os = "linux")]
    pub fn ask() -> Self {
        let said = |result: i32| if result == 0 { Ok(()) } else { Err(std::io::Error::last_os_error().to_string()) };
        // What is there now: under a small limit, locking what will come would make memory run out. SAFETY: no pointers.
        let memory = said(unsafe { libc::mlockall(libc::MCL_CURRENT) });
        let parameters = libc::sched_param { sched_priority: PRIORITY };
        // SAFETY: the parameters live through the call; 0 is the calling thread.
        let scheduling = said(unsafe { libc::sched_setscheduler(0, libc::SCHED_FIFO, &raw const parameters) });
        Self { memory, scheduling }
    }

    /// Nothing is granted here.
    #[cfg(not(target_os = "linux"))]
    pub fn ask() -> Self {
        let never = || Err("only Linux is asked".to_string());
        Self { memory: never(), scheduling: never() }
    }

    /// In words for the log.
    pub fn words(&self) -> String {
        let one = |what: &str, granted: &Result<(), String>| match granted {
            Ok(()) => format!("{what}: yes"),
            Err(why) => format!("{what}: no ({why})"),
        };
        format!("{}; {}", one("real-time scheduling", &self.scheduling), one("memory locked", &self.memory))
    }
}
