#PBS -N {{name}}
#PBS -q {{queue}}
#PBS -A {{account}}
#PBS --group={{group}}
#PBS -T openmpi
#PBS -b {{nodes}}
#PBS -l cpunum_job={{cores_per_node}}
#PBS -l elapstim_req={{time}}
#PBS -j o
#PBS -o {{output}}/job.out
{{directives}}
{{before}}

# How the {{ranks}} ranks of {{threads}} threads are started. NQSV hands Open MPI the nodes by NQSV_MPIOPTS (older: NQSII_MPIOPTS).
# shellcheck disable=SC2206  # these are several words
launch=(mpirun ${NQSV_MPIOPTS-${NQSII_MPIOPTS-}} -n {{ranks}} --map-by ppr:{{ranks_per_node}}:node:PE={{threads}} --bind-to core
  -x OMP_NUM_THREADS -x OMP_PLACES -x OMP_PROC_BIND)

job=${PBS_JOBID-}

submit_next() { qsub "$output/job.sh"; }
