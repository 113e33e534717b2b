"""Compare the free play of practical drives with the loaded model at 1e-6 of the torque: ``python benchmarks/free_play.py``.

For every drive (`ltca.testing.practical_drives`) and two crank angles the loaded model is solved on half-spaces for ± 1e-6 of
the torque at the output, and the difference of the wheel angles is compared with the free play. If no equilibrium is found,
the torque is increased tenfold. "Alike": within 1 % or 0.005′ of the free play. If both offsets of the flank are equal, the
gap vanishes where the lever vanishes. Pins there touch first, and 1e-6 of the torque still gives approaches of tenths of a
nanometre, which correspond to hundredths of an arc minute of the wheel and decrease further with the torque. "Settling": such
a position, with a difference between the free play and the play of parts that may overlap by the approaches under that load.
For these positions the limit of vanishing loads (`ltca.testing.practical_drives.light_limit`, a bound) has to agree with the
free play within 1 % or 0.005′.
"""

from __future__ import annotations

import argparse
import time

from ltca.testing.practical_drives import compare_with_load


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=300, help="number of drives (300)")
    parser.add_argument("--first", type=int, default=0, help="first seed (0)")
    options = parser.parse_args()
    counts: dict[str, int] = {}
    worst, limits, spent = 0.0, 0.0, time.process_time()
    for seed in range(options.first, options.first + options.count):
        for one in compare_with_load(seed):
            counts[one.outcome] = counts.get(one.outcome, 0) + 1
            if one.outcome != "preloaded":
                limits = max(limits, abs(one.limit - one.free))
            if one.outcome == "alike":
                worst = max(worst, one.difference)
            elif one.outcome != "preloaded":
                print(f"seed {seed}: {one}", flush=True)
    print("positions:", ", ".join(f"{number} {outcome}" for outcome, number in sorted(counts.items())))
    print(f"largest difference of positions alike {worst:.4f}′, of limits of vanishing loads {limits:.1e}′")
    print(f"{time.process_time() - spent:.0f} s")


if __name__ == "__main__":
    main()
