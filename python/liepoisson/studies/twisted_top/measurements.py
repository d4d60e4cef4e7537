"""The numbers that the study measures, as plain data: what `measurements.json` holds and what claims are judged by.

The schema (version 1).  Every estimate is `{"value", "standard_error", "low", "high"}`, the interval at 95%.

    schema_version   1
    produced_by      package, version, members, end_time, seed, tolerance, confidence, n_bootstrap
    printed          the paper's printed fit: {"lambda": 0.122, "c1": 0.113, "c0": 0.497}
    runs             by name, see `runs.plan`: twisted-unit-vectors, twisted-cube, twisted-gaussian, ordinary-unit-vectors,
                     ordinary-cube, ordinary-gaussian, twisted-halved-unit-vectors, twisted-halved-cube,
                     twisted-as-printed-unit-vectors, ordinary-as-printed-unit-vectors; each with
        inertia, a, b, epsilon, ensemble, members, end_time, seed, tolerance
        outcomes     how many members ended how, e.g. {"finished": 20000}
        n_averaged   members in the averages (those that finished)
        mean_at      {"20": estimate, "50": ..., "100", "200", "500", "1000"} of the mean exponent, as far as run
        final        {"time", "mean", "standard_deviation", "quantiles": {"0.05", "0.25", "0.5", "0.75", "0.95"}}
        fit          finite-time fit over t in [20, 200]: {"window", "n_times", "rms_residual",
                     "lambda": estimate, "c1": estimate, "c0": estimate}
        windows      the same for every window of the scan
        log_fit      t <lambda(t)> = A + B ln t over [50, 1000]: {"window", "n_times", "rms_residual", "A", "B",
                     "with_linear_term": {"A", "B", "D"}, "linear_term_is_zero"}
        steps        Taylor steps of all members
        seconds      wall time of the integration

With fewer members or an earlier end the windows are cut at the end time; `window` says what was used.
"""
