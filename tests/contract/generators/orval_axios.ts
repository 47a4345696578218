// The axios client of orval.
import axios from 'axios';

import {getUnwrapd} from './generated/orval-axios/api';
import {namesOf, type Outcome} from './outcome';

export async function unwrap(baseURL: string, mesh: Blob): Promise<Outcome> {
  axios.defaults.baseURL = baseURL;
  const {createJob, watchJob, getResult} = getUnwrapd();
  const headers = {'Content-Type': 'application/octet-stream'};
  const {data: job} = await createJob(mesh, {preset: 'chart'}, {headers});
  const events = await watchJob(job.id);
  const result = await getResult(job.id, undefined, {responseType: 'arraybuffer'});
  return {events: namesOf(events.data), asset: new Blob([result.data])};
}
