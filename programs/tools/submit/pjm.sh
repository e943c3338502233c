#PJM -N {{name}}
#PJM -g {{account}}
#PJM -L rscgrp={{queue}}
#PJM -L node={{nodes}}
#PJM -L elapse={{time}}
#PJM --mpi proc={{ranks}},max-proc-per-node={{ranks_per_node}}
#PJM -j
#PJM -o {{output}}/job_%j.out
{{directives}}
{{before}}

# How the {{ranks}} ranks of {{threads}} threads are started, by Open MPI. By Fujitsu's MPI, which learns the nodes from PJM
# and binds by itself:
#   launch=(mpiexec -n {{ranks}})
launch=(mpiexec -n {{ranks}} -machinefile "${PJM_O_NODEINF-}" --map-by ppr:{{ranks_per_node}}:node:PE={{threads}} --bind-to core
  -x OMP_NUM_THREADS -x OMP_PLACES -x OMP_PROC_BIND)

job=${PJM_JOBID-}

submit_next() { pjsub "$output/job.sh"; }
