"""./run bench --scaling: how the speed grows with ranks and threads, on one machine or in a cluster's allocation.

    plan     which runs                      analysis   medians, efficiency, Amdahl's fraction
    runner   starts them, in turn            model      what more ranks would give
    figures  the plots                       page       the HTML
"""
