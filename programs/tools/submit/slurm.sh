#SBATCH --job-name={{name}}
#SBATCH --partition={{queue}}
#SBATCH --account={{account}}
#SBATCH --nodes={{nodes}}
#SBATCH --ntasks={{ranks}}
#SBATCH --ntasks-per-node={{ranks_per_node}}
#SBATCH --cpus-per-task={{threads}}
#SBATCH --time={{time}}
#SBATCH --signal=B:USR1@{{warning}}
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output={{output}}/job.log
{{directives}}
{{before}}

# How the {{ranks}} ranks of {{threads}} threads are started. srun must be told the threads again: it does not take them
# from the lines above. Where Slurm was built without PMIx:
#   launch=(mpirun -n {{ranks}} --map-by slot:PE={{threads}} --bind-to core)
launch=(srun --mpi=pmix --ntasks={{ranks}} --cpus-per-task={{threads}} --cpu-bind=cores)

job=${SLURM_JOB_ID-}

# The same job goes back into the queue, so that `scancel JOBID` ends the whole chain. Slurm lets it wait two
# minutes or so, and ends this script while it waits here.
submit_next() {
  scontrol requeue "$job" || return
  trap - TERM
  sleep 60
}
