//! The clock. WebAssembly has none of its own: there no time passes, and no time limit comes.

#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
pub(super) use std::time::Instant;

#[cfg(all(target_family = "wasm", target_os = "unknown"))]
pub(super) use standing_still::Instant;

#[cfg(all(target_family = "wasm", target_os = "unknown"))]
mod standing_still {
    use std::time::Duration;

    #[derive(Clone, Copy, PartialEq, PartialOrd)]
    pub(in super::super) struct Instant;

    impl Instant {
        pub(in super::super) fn now() -> Instant {
            Instant
        }

        pub(in super::super) fn checked_add(self, _: Duration) -> Option<Instant> {
            None
        }

        pub(in super::super) fn duration_since(&self, _: Instant) -> Duration {
            Duration::ZERO
        }
    }
}
