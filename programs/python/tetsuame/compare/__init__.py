"""compare: runs the six programs on the note's inputs and reports what is seen.

    ./run compare [--help]

The pieces, in the order in which a run passes through them:
    study     any comparison, from the command line to the page
    options   what all command lines have
    runner    runs the cases, several at a time, and tells divergence from a crash
    results   reads what a program left: summary, residuals, snapshots
    hydrostatic (with cases, note, table, prose), convection, shock, rti   the comparisons
    figures   a file for each of these
    report    what all pages have
"""
