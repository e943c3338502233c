"""compare: runs the programs on the note's inputs and others, and reports what is seen.

    ./run compare [--help]

The pieces, in the order in which a run passes through them:
    study     any comparison, from the command line to the page
    cases     what is run on what
    runner    runs the cases, several at a time, and tells divergence from a crash
    outcomes  what a program left: summary, residuals, snapshots
    letters (with note, table, prose) and the subjects of study.SUBJECTS   the comparisons, with their figures
    orders    orders of convergence, and their figure
    parts     what all command lines and pages have
"""
