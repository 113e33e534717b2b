"""Free play of practical drives against the loaded model at a millionth of the torque: ``python benchmarks/free_play.py``.

Each drive (`ltca.testing.practical_drives`) stands at two crank angles; the loaded model balances ± 1e-6 of its torque at the
output on half-spaces, and the wheel turns between. Where that is too little to be balanced ten times as much is taken. "Alike" is
within 1 % or 0.005′ of the free play. Flanks of equal offsets have no gap where they have no lever: pins there touch first, and a
millionth of the torque still presses them by tenths of a nanometre, which are hundredths of an arcminute of the wheel; what they
turn goes on falling with the torque, down to what can be balanced. "Settling" is such a one: between the free play and the
play of parts that may overlap as much as they do under that load. For these
the limit of loads that vanish (`ltca.testing.practical_drives.light_limit`, a bound) has to be the free play by 1 % or 0.005′.
"""

from __future__ import annotations

import argparse
import time

from ltca.testing.practical_drives import compare_with_load


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=300, help="drives (300)")
    parser.add_argument("--first", type=int, default=0, help="seed of the first (0)")
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
    print(f"largest difference of those alike {worst:.4f}′, of limits of vanishing loads {limits:.1e}′")
    print(f"{time.process_time() - spent:.0f} s")


if __name__ == "__main__":
    main()
