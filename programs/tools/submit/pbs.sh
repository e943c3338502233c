#PBS -N {{name}}
#PBS -q {{queue}}
#PBS -A {{account}}
#PBS -W group_list={{group}}
#PBS -l select={{nodes}}:ncpus={{cores_per_node}}:mpiprocs={{ranks_per_node}}:ompthreads={{threads}}
#PBS -l walltime={{time}}
#PBS -r y
#PBS -j oe
#PBS -o {{output}}/job.out
{{directives}}
{{before}}

# How the {{ranks}} ranks of {{threads}} threads are started. mpirun learns the nodes from PBS.
launch=(mpirun -n {{ranks}} --map-by slot:PE={{threads}} --bind-to core
  -x OMP_NUM_THREADS -x OMP_PLACES -x OMP_PROC_BIND)

job=${PBS_JOBID-}

submit_next() { qsub "$output/job.sh"; }
