#!/usr/bin/env python3
"""Guards against slow-downs that a shared machine's clock cannot see: counts instructions under valgrind.

    python3 benches/instructions.py             counts each job of benches/instructions.rs; fails where one takes over 5 %
                                                more than benches/instructions.txt keeps, or is not kept
    python3 benches/instructions.py --update    keeps the new counts: commit them with the change, and say why it is worth it

Needs valgrind. Counts depend on the compiler, so the kept file names the version of rustc; under another one, differences
are reported and nothing fails.
"""
import json, os, re, subprocess, sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
KEPT = ROOT / "benches" / "instructions.txt"
MOST = 1.05


def output(*command, **more):
    return subprocess.run(command, cwd=ROOT, check=True, text=True, stdout=subprocess.PIPE, **more).stdout


def built():
    """The bench without target flags: valgrind rounds to nearest only, see benches/instructions.rs."""
    messages = output("cargo", "bench", "--bench", "instructions", "--no-run", "--target-dir", "target/portable",
                      "--message-format=json", env=os.environ | {"RUSTFLAGS": ""})
    artifacts = [json.loads(line) for line in messages.splitlines()]
    return next(a["executable"] for a in artifacts if a.get("target", {}).get("name") == "instructions")


def counted(program, job):
    done = subprocess.run(["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null",
                           "--toggle-collect=*instructions*measured*", program, job],
                          text=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    collected = re.search(r"Collected : (\d+)", done.stderr)
    if done.returncode or not collected or int(collected[1]) == 0:
        sys.exit(f"{job}: nothing counted\n{done.stderr}")
    return int(collected[1])


def kept():
    if not KEPT.exists():
        return "no compiler", {}
    rustc, *rows = (line for line in KEPT.read_text().splitlines() if not line.startswith("#"))
    return rustc, {job: int(count) for job, count in map(str.split, rows)}


def main():
    rustc, (kept_rustc, before) = output("rustc", "--version").strip(), kept()
    program = built()
    # natively, each answer asserted
    counts = {job: counted(program, job) for job in output(program).split()}
    slower = []
    for job, count in counts.items():
        old = before.get(job)
        print(f"{job:22}{count:>14,}" + (f"{100 * (count / old - 1):+8.1f} %" if old else "   not kept"))
        if old is None or count > MOST * old:
            slower.append(job)
    if "--update" in sys.argv:
        rows = "".join(f"{job} {count}\n" for job, count in counts.items())
        KEPT.write_text(f"# instructions of each job; written by benches/instructions.py --update\n{rustc}\n{rows}")
    elif kept_rustc != rustc:
        print(f"the kept counts are of {kept_rustc}, this is {rustc}: nothing fails")
    elif slower:
        sys.exit(f"over 5 % more instructions than kept, or not kept: {', '.join(slower)}\n"
                 "if that is worth it: benches/instructions.py --update, and commit benches/instructions.txt")


if __name__ == "__main__":
    main()
