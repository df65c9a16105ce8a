// Calls to the program: words as JSON, geometry as typed arrays, long work with progress (server-sent events). Ending
// a call (AbortSignal) ends its work in the program.

export type Words = Record<string, unknown>;
export type NumberArray = Float32Array | Float64Array | Uint32Array | Uint8Array;

export interface Answer {
  words: Words;
  arrays: Record<string, NumberArray>;
}

/** What the program said went wrong. `kind` is one of its error kinds, or "connection". */
export class CallError extends Error {
  constructor(readonly kind: string, message: string) {
    super(message);
  }
}

export type Progress = (stage: string, fraction: number) => void;

const KEY = 'retalho-session';
let session = '';

/** The one-time token that an address's fragment holds, and the fragment without it. */
export function splitToken(fragment: string): {token: string; rest: string} {
  const token = /(?:^#|&)token=([\w-]+)/.exec(fragment)?.[1] ?? '';
  const rest = fragment.replace(/^#/, '').split('&').filter((part) => part !== '' && !part.startsWith('token=')).join('&');
  return {token, rest};
}

/**
 * Exchanges the address's token for the session's secret, once, and takes it out of the address (so that it is in no
 * bookmark). The secret stays with this tab: a reload finds it, and so does a duplicate of the tab. Throws CallError.
 */
export async function openSession(): Promise<void> {
  session = sessionStorage.getItem(KEY) ?? '';
  const {token, rest} = splitToken(location.hash);
  if (token === '') {
    if (session === '') throw new CallError('refused', 'This address lacks its token. Use the whole address that `retalho view` printed, or "New tab" in a tab that is open already');
    return;
  }
  history.replaceState(null, '', rest ? '#' + rest : location.pathname);
  const response = await post('/api/session', {}, {'X-Retalho-Token': token});
  const words = (await response.json()) as Words;
  if (response.ok) {
    session = String(words.session);
    sessionStorage.setItem(KEY, session);
  } else if (session === '') {  // with one, this tab is where the token was used before: it goes on
    throw new CallError('refused', 'This address has been used already: it opens the page once. Go on in the tab that it opened, where "New tab" opens another. If that was not you, end the program with Ctrl-C and run `retalho view` again');
  }
}

/** The address of a further tab, good once. */
export async function newTabAddress(): Promise<string> {
  return `/#token=${String((await ask('/api/session/token')).words.token)}`;
}

async function post(path: string, input: Words, headers: Record<string, string>, signal?: AbortSignal): Promise<Response> {
  try {
    return await fetch(path, {
      method: 'POST',
      headers: {'Content-Type': 'application/json', ...headers},
      body: JSON.stringify(input),
      signal,
      cache: 'no-store',
    });
  } catch (error) {
    if (signal?.aborted) throw error;
    throw new CallError('connection', 'the program does not answer: it has ended, or was stopped. Run `retalho view` again');
  }
}

function send(path: string, input: Words, signal?: AbortSignal): Promise<Response> {
  return post(path, input, {'X-Retalho-Session': session}, signal);
}

function errorOf(words: Words): CallError {
  const e = (words.error ?? {}) as {kind?: string; message?: string};
  return new CallError(e.kind ?? 'internal', e.message ?? 'the program gave no reason');
}

/** The binary form of an answer (viewer/calls.h, pack). */
export function unpack(buffer: ArrayBuffer): Answer {
  const view = new DataView(buffer);
  if (buffer.byteLength < 8 || view.getUint32(0, false) !== 0x52544c31) throw new CallError('internal', 'an answer is damaged');
  const length = view.getUint32(4, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 8, length))) as {
    words: Words;
    arrays: {name: string; type: string; offset: number; count: number}[];
  };
  const start = Math.ceil((8 + length) / 8) * 8;
  const arrays: Record<string, NumberArray> = {};
  for (const {name, type, offset, count} of header.arrays) {
    const at = start + offset;
    arrays[name] =
      type === 'f32' ? new Float32Array(buffer, at, count)
      : type === 'f64' ? new Float64Array(buffer, at, count)
      : type === 'u32' ? new Uint32Array(buffer, at, count)
      : new Uint8Array(buffer, at, count);
  }
  return {words: header.words, arrays};
}

async function answerOf(response: Response): Promise<Answer> {
  if (response.headers.get('Content-Type')?.startsWith('application/octet-stream')) return unpack(await response.arrayBuffer());
  const words = (await response.json()) as Words;
  if (!response.ok) throw errorOf(words);
  return {words, arrays: {}};
}

/** A quick call. */
export async function ask(path: string, input: Words = {}, signal?: AbortSignal): Promise<Answer> {
  return answerOf(await send(path, input, signal));
}

/** Splits a stream of server-sent events into [name, data]; what is incomplete stays in `rest`. */
export function splitEvents(text: string): {events: [string, string][]; rest: string} {
  const parts = text.split('\n\n');
  const rest = parts.pop() ?? '';
  const events = parts.map((part): [string, string] => {
    let name = '', data = '';
    for (const line of part.split('\n')) {
      if (line.startsWith('event: ')) name = line.slice(7);
      if (line.startsWith('data: ')) data += line.slice(6);
    }
    return [name, data];
  });
  return {events, rest};
}

/** A long call: progress as it comes, then the answer. */
export async function work(path: string, input: Words, progress: Progress, signal?: AbortSignal): Promise<Answer> {
  const response = await send(path, input, signal);
  if (!response.body || !response.headers.get('Content-Type')?.startsWith('text/event-stream')) return answerOf(response);
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = '';
  for (;;) {
    let chunk: ReadableStreamReadResult<string>;
    try {
      chunk = await reader.read();
    } catch (error) {
      if (signal?.aborted) throw error;
      throw new CallError('connection', 'the program ended while it was working');
    }
    if (chunk.done) throw new CallError('connection', 'the program ended while it was working');
    const split = splitEvents(rest + chunk.value);
    rest = split.rest;
    for (const [name, data] of split.events) {
      const words = JSON.parse(data) as Words;
      if (name === 'progress') progress(String(words.stage), Number(words.fraction));
      if (name === 'failed') throw errorOf(words);
      if (name !== 'done') continue;
      if (words.result === undefined) return {words: words.words as Words, arrays: {}};
      return ask('/api/result', {id: words.result}, signal);
    }
  }
}
