"""./run bench --scaling: how the speed grows with ranks and threads, on one machine or in a cluster's allocation.

    application  the command line        analysis   medians, efficiency, Amdahl's fraction
    runner       which runs, in turn     model      what more ranks would give
                                         page       the HTML and its plots
"""
