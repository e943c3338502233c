#!/bin/bash
# {{program_name}} on {{ranks}} ranks of {{threads}} threads, made by
#   {{command}}
# Submit it by
#   {{submit_command}}
# It starts the run, or continues it from the newest checkpoint in the output directory, and ends {{margin}} s before
# the time is up, after a checkpoint. Then it submits itself again, until the run is complete.
# What happened stands in job.log there. `bash job.sh` runs it without a scheduler, up to the first end.
