#!/usr/bin/env python3
"""Time and memory of `mindahl track` against the length of the record, and time against threads.

    bench/peers/scaling.py [--build build/release] [--longest 1000000] [--plot docs/images/scaling.svg]

The record is that of campaign.py, of 1000 cycles, repeated on a pipe: no file of 12 GB is written.
Prints the tables of docs/performance.md and draws them with gnuplot.
"""
import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import threading
import time

from campaign import CONTACT

PIECE = 100  # cycles that are repeated

FIGURE = """
set terminal svg size 900,360 font "sans,12" background rgb "white"
set output "{path}"
set multiplot layout 1,2
set grid lc rgb "#dddddd"
set logscale x
set xlabel "cycles of 200 samples"
set format x "10^{{%T}}"
set key left top
set logscale y
set ylabel "time [s]"
plot {times}
unset logscale y
set key right bottom
set yrange [0:*]
set ylabel "greatest memory [MB]"
plot {memories}
"""


def feed(pipe, header, body, repeats):
    with pipe:
        pipe.write(header)
        for _ in range(repeats):
            try:
                pipe.write(body)
            except BrokenPipeError:
                return


def greatest_memory(process):
    """[MB] of a process so far. Not what wait4 says, which begins with this interpreter's."""
    try:
        status = pathlib.Path(f"/proc/{process}/status").read_text()
    except OSError:
        return 0.0
    lines = [line for line in status.splitlines() if line.startswith("VmHWM:")]
    return float(lines[0].split()[1]) / 1024 if lines else 0.0


def cost_of(program, record, repeats, threads, table):
    """(seconds, processor seconds, greatest resident memory [MB])."""
    header, body = record
    start = time.monotonic()
    process = subprocess.Popen(
        [program, "track", "/dev/stdin", "--output", table, "--overwrite", "--threads",
         str(threads)], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    feeder = threading.Thread(target=feed, args=(process.stdin, header, body, repeats))
    feeder.start()
    memory = 0.0
    while True:
        memory = max(memory, greatest_memory(process.pid))
        ended, status, usage = os.wait4(process.pid, os.WNOHANG)
        if ended:
            break
        time.sleep(0.005)
    elapsed = time.monotonic() - start
    feeder.join()
    if status != 0:
        sys.exit(f"mindahl track failed on {repeats * PIECE} cycles")
    return elapsed, usage.ru_utime + usage.ru_stime, memory


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", default="build/release", type=pathlib.Path)
    parser.add_argument("--longest", default=1_000_000, type=int, help="cycles")
    parser.add_argument("--plot", type=pathlib.Path)
    arguments = parser.parse_args()
    program = arguments.build / "src/mindahl"
    threads = range(1, len(os.sched_getaffinity(0)) + 1)
    costs = {count: [] for count in threads}
    with tempfile.TemporaryDirectory() as directory:
        piece = os.path.join(directory, "piece.csv")
        table = os.path.join(directory, "table.csv")
        subprocess.run([program, *CONTACT, "--cycles", str(PIECE), "-o", piece], check=True)
        header, *rows = pathlib.Path(piece).read_bytes().splitlines(keepends=True)
        record = header, b"".join(rows[:-1])  # the last is where the next piece begins
        cycles = PIECE
        while cycles <= arguments.longest:
            for count in threads:
                costs[count].append(
                    (cycles, *cost_of(program, record, cycles // PIECE, count, table)))
            cycles *= 10
    print("| cycles | threads | time [s] | processor time [s] | time over one thread's | greatest "
          "memory [MB] |\n|---|---|---|---|---|---|")
    for k, (cycles, alone, _, _) in enumerate(costs[1]):
        for count in threads:
            _, elapsed, processor, memory = costs[count][k]
            print(f"| {cycles} | {count} | {elapsed:.3g} | {processor:.3g} | "
                  f"{elapsed / alone:.3g} | {memory:.3g} |")
    if arguments.plot:
        def series(column):
            lines = []
            for count in threads:
                name = "one thread" if count == 1 else f"{count} threads"
                lines.append(f"'-' using 1:2 with linespoints lw 2 pt 7 ps 0.6 title '{name}'")
            data = "".join("\n".join(f"{row[0]} {row[column]}" for row in costs[count]) + "\ne\n"
                           for count in threads)
            return ", ".join(lines) + "\n" + data
        subprocess.run(["gnuplot"], input=FIGURE.format(
            path=arguments.plot, times=series(1), memories=series(3)), text=True, check=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
