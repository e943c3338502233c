#!/usr/bin/env python3
"""What bounds each pass over neighbours. The instructions of a pair are found in a program's object code, counted by
kinds, handed to llvm-mca's models of processors, and run by themselves on the one at hand
(docs/studies/2026-11-24_what_bounds_each_pass.md).

    python3 docs/figures/pass_limits.py build/programs/avx512                            # the table
    python3 docs/figures/pass_limits.py build/programs/avx512 --measure                  # with times on this processor
    python3 docs/figures/pass_limits.py build/programs/avx512 --passes C_forces --show > pass.s   # the instructions
    python3 docs/figures/pass_limits.py pass.s --measure                                 # of these, after a change

Of programs with AVX-512. Needs binutils and llvm-mca (19 or later, for Zen 4); to measure, a C compiler.
"""

import argparse
import re
import shutil
import subprocess
import tempfile
from collections import Counter, deque
from pathlib import Path

QUINTIC, C2, C6 = (f"tetsuame::kernels::{name}>" for name in ("spline<{D}, 5", "wendland<{D}, 2", "wendland<{D}, 6"))
BOTH = f"tetsuame::kernels::in_common<{QUINTIC} >"
FORCES = ("tetsuame::gradient::pattern_1::term<{D}>, tetsuame::gradient::continuity<{D}>, "
          "tetsuame::diffusion::viscous_sum<{D}, double")
DERIVATIVES = "tetsuame::operators::consistent<{D}, {fields}"
# Of each pass: the program that has it, and what the name of its sum over a row ends with: kernel and terms.
PASSES = {
    "C_smoothing": ("bench", f">, {QUINTIC}, tetsuame::volume::weight_sum<{{D}}, false> >"),
    "C_forces": ("bench", f">, {QUINTIC}, {FORCES}, {{D}}ul, true> >"),
    "C_forces_with_heat": ("bench", f">, {QUINTIC}, {FORCES} const*, {{D}}ul, true>, tetsuame::diffusion::conduction<{{D}}> >"),
    "C_at_walls": ("bench", f">, {QUINTIC}, tetsuame::diffusion::viscous_sum<{{D}}, double, 1ul, false> >"),
    "C_smoothing_at_walls": (
        "disph_c", f", {BOTH}, tetsuame::diffusion::viscous_sum<{{D}}, double, 1ul, false, true>, tetsuame::volume::weight_sum<{{D}}, false> >"),
    "rti_volumes": ("rti", f">, {C6}, tetsuame::volume::number_volume<{{D}}> >"),
    "rti_forces": ("rti", f">, {C6}, tetsuame::two_fluids::forces<{{D}}, false> >"),
    # Of a step's first stage, and of the others; fields: v, T, p and the relaxed velocity.
    "convection_first": ("convection", f">, {C2}, {DERIVATIVES}, true, {{wanted}}u>, "),
    "convection_stage": ("convection", f">, {C2}, {DERIVATIVES}, false, {{wanted}}u>, "),
    "gdisph_densities": ("bench", f"tetsuame::schemes::density<{{D}}, {QUINTIC} > >"),
    "gdisph_gradients": ("bench", f"tetsuame::schemes::gradients<{{D}}, {QUINTIC} > >"),
    "gdisph_rates": ("bench", f"tetsuame::schemes::gdisph<{{D}}, {QUINTIC} > >"),
}
# Their pairs take the long way (here the tensor B, which is always at hand); others the short one (no exact Riemann
# problem, which is a choice).
TAKES_LONG_WAY = ("convection_first", "convection_stage")
MODELS = ["znver4", "skylake-avx512", "icelake-server", "sapphirerapids"]
NUMBERS = {"double": "std::experimental::parallelism_v2::simd<double", "single": "tetsuame::foundation::single"}


def output_of(*command, text=None):
    return subprocess.run([str(c) for c in command], check=True, capture_output=True, text=True, input=text).stdout


def code_of(program, address, size):
    """(address, mnemonic, operands) of a function's instructions."""
    text = output_of("objdump", "-d", "--no-show-raw-insn", f"--start-address={address}",
                     f"--stop-address={address + size}", program)
    found = re.findall(r"^ +([0-9a-f]+):\t(?:(?:notrack|bnd|data16|cs) )*(\S+) *([^#<\n]*)", text, re.M)
    return [(int(address, 16), name, operands.strip()) for address, name, operands in found]


def ways(code, long_way):
    """A pair's instructions in the order in which they run: the shortest way from each estimate of 1/r back
    to itself. On the long way, jumps over a part of the loop are not taken."""
    at = {address: n for n, (address, _, _) in enumerate(code)}

    def next_of(n):
        _, name, operands = code[n]
        target = at.get(int(operands, 16)) if name.startswith("j") and re.fullmatch("[0-9a-f]+", operands) else None
        if name == "call":  # of what is rarely asked for: the exact Riemann problem
            return []
        if name == "jmp":
            return [] if target is None else [target]
        following = [n + 1] if n + 1 < len(code) and name != "ret" else []
        if target is not None and not (long_way and n < target < n + 100):
            following.append(target)
        return following

    def way_back_to(estimate):
        before, reached = {estimate: None}, deque([estimate])
        while reached:
            n = reached.popleft()
            for following in next_of(n):
                if following == estimate:
                    way = []
                    while n is not None:
                        way.append(code[n][1:])
                        n = before[n]
                    return way[::-1]
                if following not in before:
                    before[following] = n
                    reached.append(following)
        return None

    estimates = [n for n, (_, name, _) in enumerate(code) if name.startswith("vrsqrt14p")]
    return [way for way in map(way_back_to, estimates) if way]


# The first pattern that an instruction begins with.
KINDS = {
    "divisions, roots": r"v(div|sqrt|rsqrt|rcp)",
    "multiplications": r"v(mul|fn?m(add|sub))",
    "additions, comparisons": r"v(add|sub|max|min|cmp|p?and|p?or|p?xor|ptern|padd|psub|cvt|blend|ptest|range|scalef)",
    "shuffles": r"v(perm|unpck|shuf|insert|extract)|vp?broadcast\S* %|k",
    "copies": r"vmov\S* %\S+,%",
    "stores": r"vmov\S* %\S+,[^%]*\(",
    "loads": r"v",
    "integers, jumps": r"",
}


def kinds_of(way):
    counts = Counter(next(k for k, p in KINDS.items() if re.match(p, f"{name} {operands}")) for name, operands in way)
    counts["of the stack"] = sum(name.startswith("v") and bool(re.search(r"\(%r[sb]p\)", operands))
                                 for name, operands in way)
    return counts


def assembly(way):
    """Without the targets of jumps, which nobody takes here."""
    return "".join(f"\t{name}\t{'1f' if name.startswith('j') else operands}\n" for name, operands in way) + "1:\n"


def model(mca, processor, way):
    """Of a pair: cycles; and (cycles of it, name) of the units, the busiest first."""
    turns = 200
    text = output_of(mca, "-mtriple=x86_64", f"-mcpu={processor}", f"-iterations={turns}", text=assembly(way))
    cycles = int(re.search(r"Total Cycles: +(\d+)", text)[1]) / turns
    units = dict(re.findall(r"^\[([\d.]+)\] +- (\S+)$", text, re.M))
    heads, values = re.search(r"Resource pressure per iteration:\n(.*)\n(.*)", text).groups()
    taken = zip(re.findall(r"\[([\d.]+)\]", heads), values.split())
    return cycles, sorted(((float(v), units[k]) for k, v in taken if v != "-"), reverse=True)


TIMER = """#include <stdio.h>
#include <time.h>
void loop(void), chain(void);
static double time_of(void (*f)(void)) {
  struct timespec a, b;
  clock_gettime(CLOCK_MONOTONIC, &a);
  f();
  clock_gettime(CLOCK_MONOTONIC, &b);
  return 1e9 * (b.tv_sec - a.tv_sec) + (b.tv_nsec - a.tv_nsec);
}
int main(void) {
  double least[2] = {1e99, 1e99};
  for (int k = 0; k < 1000; ++k) {
    const double t[2] = {time_of(loop), time_of(chain)};
    for (int m = 0; m < 2; ++m) least[m] = t[m] < least[m] ? t[m] : least[m];
  }
  printf("%.17g %.17g\\n", least[0], least[1]);
}
"""
# One addition a cycle.
CHAIN = "\t.globl chain\nchain:\tmovl $100000, %eax\n\t.p2align 6\n1:\tsubl $1, %eax\n\tjnz 1b\n\tret\n"


def times(folder, text):
    """Least times in ns of a cycle, and of a call of the function `loop`."""
    (folder / "loop.s").write_text(text + "\t.text\n" + CHAIN)
    (folder / "main.c").write_text(TIMER)
    output_of("cc", "-O1", "-no-pie", folder / "main.c", folder / "loop.s", "-o", folder / "loop")
    loop, chain = output_of(folder / "loop").split()
    return float(chain) / 100_000, float(loop)


def placed(operands, stack):
    """Operands in memory moved to where %r9 points, those of the stack to their places behind %r8, so that what is put
    there is found again; registers of integers made one that nobody needs."""
    def at(match):
        if match[2] in ("(%rsp)", "(%rbp)"):
            return f"{int(match[1] or '0', 16) + stack}(%r8)"
        one = "{1to" in operands or not re.search(r"%zmm", operands)
        return f"{int(match[1] or '0', 16) % 64 // 8 * 8 if one else 0}(%r9)"

    moved = re.sub(r"(-?0x[0-9a-f]+)?(\([^)]*\))", at, operands)
    return re.sub(r"%(?!r[89]\))([er][a-ds][ixp]|r1?\d)(d?)\b(?!\))",
                  lambda m: "%r10d" if m[2] or m[1].startswith("e") else "%r10", moved)


def cycles_here(folder, way, single, turns=5_000, tries=6):
    """Of a pair, and cycles a ns: the data in the first cache, no guess at a jump that fails, an addition for each
    instruction on integers. Of some tries that with the fastest clock: other work on the core slows the chain too."""
    aligned = [int(d, 16) for name, operands in way if "%zmm" in operands and re.match("vmovap|vmovdqa", name)
               for d in re.findall(r"(-?0x[0-9a-f]+)\(%r[sb]p\)", operands)]
    stack = -aligned[0] % 64 if aligned else 0
    body = []
    for name, operands in way:
        if name.startswith("v") or (name.startswith("k") and "(" not in operands):
            body.append(f"\t{name}\t{placed(operands, stack)}")
        else:
            body.append("\taddl\t$1, %ecx")
    half = ".quad 0x3f0000003f000000" if single else ".quad 0x3fe0000000000000"
    registers = "".join(f"\tvmovupd\t(%r9), %zmm{n}\n" for n in range(32))
    masks = "".join(f"\tkmovw\t%r10d, %k{n}\n" for n in range(1, 8))
    # Numbers too small to be normal, which some processors are slow with, are off: bits 15 and 6.
    text = (
        "\t.globl loop\nloop:\tleaq data(%rip), %r9\n\tleaq 0x8000(%r9), %r8\n"
        "\tstmxcsr -8(%rsp)\n\tmovl -8(%rsp), %eax\n\torl $0x8040, %eax\n\tmovl %eax, -4(%rsp)\n"
        f"\tldmxcsr -4(%rsp)\n\tmovl $0xffff, %r10d\n{masks}{registers}\tmovl ${turns}, %eax\n\t.p2align 6\n"
        "1:\n" + "\n".join(body) + "\n\tsubl $1, %eax\n\tjnz 1b\n\tldmxcsr -8(%rsp)\n\tvzeroupper\n\tret\n"
        f"\t.data\n\t.p2align 6\ndata:\n\t.rept 16384\n\t{half}\n\t.endr\n")
    cycle, loop = min(times(folder, text) for _ in range(tries))
    return loop / cycle / turns, 1.0 / cycle


def passes(folder, names, dimensions):
    """(name, precision, way) of each that a program has."""
    sums = {}
    for D in dimensions:
        of_dimension = {"D": D, "fields": 2 * D + 2, "wanted": (1 << D) + (((1 << D) - 1) << (D + 2))}
        for name in names:
            program, end = PASSES[name]
            if program not in sums:
                lines = output_of("nm", "-S", "-C", folder / program).splitlines()
                sums[program] = [line.split(" ", 3) for line in lines if "::sum_row<" in line]
            for precision, number in NUMBERS.items():
                named = (line for line in sums[program]
                         if f"sum_row<{number}" in line[3] and end.format(**of_dimension) in line[3].split("(")[0])
                if of := next(named, None):
                    code = code_of(folder / program, int(of[0], 16), int(of[1], 16))
                    yield f"{name}, {D}-D", precision, min(ways(code, name in TAKES_LONG_WAY), key=len)


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("source", type=Path, help="folder of the programs, build/programs/avx512; or instructions")
    options.add_argument("--passes", nargs="+", choices=PASSES, default=list(PASSES), metavar="PASS")
    options.add_argument("--dimensions", nargs="+", type=int, default=[2])
    options.add_argument("--models", nargs="+", default=MODELS)
    options.add_argument("--mca", default=next(filter(shutil.which, ["llvm-mca-22", "llvm-mca-19"]), "llvm-mca"))
    options.add_argument("--measure", action="store_true", help="run the instructions on this processor too")
    options.add_argument("--show", action="store_true", help="print the instructions, nothing else")
    chosen = options.parse_args()
    if chosen.source.is_dir():
        found = passes(chosen.source, chosen.passes, chosen.dimensions)
    else:
        text = chosen.source.read_text()
        way = [(name, operands.strip()) for name, operands in re.findall(r"^\s+([a-z]\w*)[ \t]*(.*)", text, re.M)]
        found = [(chosen.source.name, "single" if re.search(r"vmulps|vfn?m\S*ps", text) else "double", way)]
    if chosen.show:
        for name, precision, way in found:
            print(f"# {name}, {precision}\n{assembly(way)}")
        return
    counts = [*KINDS, "of the stack"]
    heads = ["pass", "precision", *counts, *chosen.models, *(["here, cycles", "GHz"] if chosen.measure else [])]
    print("|", " | ".join(heads), "|\n|" + "---|" * len(heads))
    with tempfile.TemporaryDirectory() as temporary:
        for name, precision, way in found:
            kinds = kinds_of(way)
            cells = [name, precision, *(str(kinds[k]) for k in counts)]
            for processor in chosen.models:
                cycles, units = model(chosen.mca, processor, way)
                cells.append(f"{cycles:.0f} (" + ", ".join(f"{unit} {taken:.0f}" for taken, unit in units[:3]) + ")")
            if chosen.measure:
                cycles, clock = cycles_here(Path(temporary), way, precision == "single")
                cells += [f"{cycles:.1f}", f"{clock:.2f}"]
            print("|", " | ".join(cells), "|", flush=True)


if __name__ == "__main__":
    main()
