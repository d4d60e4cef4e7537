import sys; sys.path.insert(0,'/work/main/benchmarks')
import time, numpy as np, heyoka as hy, heyoka_worker as w
hy.llvm_state.set_diskcache_enabled(False)
x0=np.load('/tmp/b/x0.npy')
def best(f, n=7):
    b=1e9
    for _ in range(n):
        t=time.perf_counter(); r=f(); b=min(b,time.perf_counter()-t)
    return b*1e3
for tol in (1e-15,1e-16/2):
  ta=hy.taylor_adaptive(w.top_system(tangent=False),np.zeros(9),tol=tol)
  for span in (1000.,100.,10000.):
    ts=np.linspace(0,span,100001)[1:]
    def run(c):
        ta.time=0.0; ta.state[:]=x0[0]; return ta.propagate_until(span,c_output=c)
    c=run(True)[4]
    print('order',ta.order,'span',span,'plain',best(lambda:run(False)),'dense run',best(lambda:run(True)),'eval',best(lambda:c(ts)))
    grid=np.concatenate([[0],ts])
    def g():
        ta.time=0.0; ta.state[:]=x0[0]; return ta.propagate_grid(grid)
    print('  grid',best(g))
