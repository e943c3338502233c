"""compare: runs the six programs on the note's inputs and reports what is seen.

    ./run compare [--help]

The pieces, in the order in which a run passes through them:
    options   the command line
    cases     which program runs on which input with which settings
    runner    runs them, several at a time, and tells divergence from a crash
    results   reads what a program left: summary, residuals, snapshots
    note      what the note reports, the figures that are compared with
    table     the tables: terminal, CSV
    figures   one file a figure
    prose     the explanation, with the numbers of these runs
    report    the HTML page
"""
