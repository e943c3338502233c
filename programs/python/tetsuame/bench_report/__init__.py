"""The page of `./run bench`: reads bench.json, writes report.html beside it.

    results  what bench measured          others  figures of other codes, with their source
    figures  the plots                    page    the HTML
"""
