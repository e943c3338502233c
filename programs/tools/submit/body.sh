
# ---- what is run ----------------------------------------------------------------------------
cd {{directory}} || exit 4
program={{program}}
input={{input}}
settings=({{settings}})
output={{output}}
# s a job has, as asked for above, and what of it is kept for the last step, the checkpoint and the end.
job_seconds={{seconds}}
margin={{margin}}
# s, run.wall_clock_limit of the input; 0: none.
own_limit={{own_limit}}
# The chain ends after so many jobs, whatever happens. self: a job submits the next; ahead: all were submitted at once.
max_jobs={{max_jobs}}
chain={{chain}}

export OMP_NUM_THREADS={{threads}} OMP_PLACES=cores OMP_PROC_BIND=close
# s. Open MPI's mpirun that is ended itself hands SIGTERM on after so long, kills after as long again, and returns 1: its
# own 1 s is short for a checkpoint of ranks that the scheduler ended with it. But mpirun waits twice so long after
# every run that ends with a status, too, 75 among them, and this has to fit into the margin.
: "${OMPI_MCA_odls_base_sigkill_timeout:=$((margin < 12 ? 1 : margin > 60 ? 10 : margin / 6))}"
export OMPI_MCA_odls_base_sigkill_timeout

# ---- the chain so far -----------------------------------------------------------------------
# job.state: how the last job ended, how many there were, the step the last one began at (-1: anew) and how many
# jobs in a row began there.
state=$output/job.state
outcome=new jobs=0 began=none again=0

say() { printf '%s  job %s: %s\n' "$(date '+%F %T')" "${job:-here}" "$*" >>"$output/job.log"; }

remember() { printf '%s %s %s %s\n' "$1" "$jobs" "$began" "$again" >"$state.tmp" && mv "$state.tmp" "$state"; }

# stop STATUS REASON: no further job.
stop() {
  remember stopped
  say "stopped: $2"
  exit "$1"
}

# The step of the newest checkpoint, -1 if there is none.
newest_step() {
  local path number newest=-1
  for path in "$output"/checkpoint_*.h5; do
    [[ $path =~ checkpoint_([0-9]+)\.h5$ ]] || continue
    number=$((10#${BASH_REMATCH[1]}))
    ((number <= newest)) || newest=$number
  done
  printf '%s' "$newest"
}

# read fails, too, on a file that a full disk left empty.
if ! [[ -r $state ]] || ! read -r outcome jobs began again <"$state"; then outcome=new jobs=0 began=none again=0; fi
case $chain:$outcome in
  ahead:completed) say "nothing left to do"; exit 0 ;;
  ahead:stopped) say "the job before stopped the chain"; exit 1 ;;
  self:completed | self:stopped) jobs=0 began=none again=0 ;;  # submitted again by hand: a new chain
esac

from=$(newest_step)
jobs=$((jobs + 1))
if [[ $from == "$began" ]]; then again=$((again + 1)); else began=$from again=1; fi
((jobs <= max_jobs)) || stop 1 "$max_jobs jobs were not enough (--max-jobs)"
((again <= 2)) || stop 1 "two jobs in a row were ended from outside and left no checkpoint after step $from: ask for \
more time, or for more frequent checkpoints by --set run.checkpoint_seconds"
remember running

# Before the first checkpoint a killed run starts anew. --force clears away what it left, and only that: other files
# in the directory stay.
if ((from < 0)); then start=(--force); else start=(--restart latest); fi
limit=$((job_seconds - margin - SECONDS))
((limit >= 1)) || limit=1
((own_limit == 0 || own_limit >= limit)) || limit=$own_limit

# ---- the run --------------------------------------------------------------------------------
say "number $jobs, $( ((from < 0)) && echo 'from the start' || echo "from step $from"), for $limit s"
# In the background, for the shell heeds signals only while it waits. USR1 warns that the time is nearly up; TERM,
# or INT or HUP where no scheduler runs this, say that somebody ends the job: then no further one is submitted. mpirun
# is told by USR1 in any case, which it hands on at once and does not end for.
ended=false
"${launch[@]}" "$program" "$input" "${settings[@]}" --set run.wall_clock_limit="$limit" --output "$output" "${start[@]}" \
  >>"$output/job.log" 2>&1 &
child=$!
trap 'kill -USR1 "$child"' USR1
trap 'ended=true; kill -USR1 "$child"' TERM INT HUP
while
  wait "$child"
  status=$?
  ((status > 128)) && kill -0 "$child" 2>/dev/null
do :; done
trap '' USR1 TERM INT HUP

# ---- what comes next ------------------------------------------------------------------------
reached=$(newest_step)
case $status in
  0)
    remember completed
    say "completed"
    exit 0
    ;;
  75) ;;
  2) stop 2 "the input was refused, see above" ;;
  3) stop 3 "the calculation failed, see above and summary.json" ;;
  4) stop 4 "a file could not be read or written, see above" ;;
  # Of an mpirun that was ended from outside it says nothing of the run.
  *) $ended || stop "$status" "the run ended with status $status, see above; the newest checkpoint is of step $reached (-1: none)" ;;
esac
# Where the newest checkpoint was damaged, the run began at the one before.
used=$(sed -n 's/.*continuing from .*checkpoint_0*\([0-9][0-9]*\)\.h5.*/\1/p' "$output/run.log" | tail -n 1)
((from < 0)) || from=${used:-$from}
if $ended; then
  ((reached > from)) || stop 75 "ended from outside before a checkpoint; {{submit_command}} begins where this job did"
  stop 75 "ended from outside after a checkpoint at step $reached; {{submit_command}} continues"
fi
((reached > from)) || stop 1 "no step was completed in $limit s: ask for more time"
remember interrupted
say "step $reached; to be continued"
[[ $chain == self ]] || exit 75
((jobs < max_jobs)) || stop 1 "$max_jobs jobs were not enough (--max-jobs); {{submit_command}} continues"
submit_next >>"$output/job.log" 2>&1 ||
  stop 75 "the next job could not be submitted from here; on the login node: {{submit_command}}"
exit 75
