// The connection: requests with their answers, and messages of which the newest counts.

/** The header and the parts of a binary message (docs/live.md). */
function unpack(buffer) {
  const size = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, size)));
  let at = 4 + size;
  const parts = (header.parts ?? []).map((length) => {
    at += length;
    return buffer.slice(at - length, at);
  });
  return {header, parts};
}

/** A connection that nothing came over for this long is asked for a sign; again as long later it is given up. */
const silence_ms = 4000;

class Link {
  /** `take(header, parts)` draws a message, and may return a promise; `open(is_open)` is told of the connection. */
  constructor(take, opened) {
    Object.assign(this, {take, opened, answers: new Map(), ids: 0, wait_ms: 250});
    this.connect();
  }

  connect() {
    const address = new URL('socket' + location.search, location.href);
    address.protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
    this.socket = new WebSocket(address);
    this.socket.binaryType = 'arraybuffer';
    this.socket.onopen = () => { this.wait_ms = 250; this.opened(true); };
    this.socket.onmessage = ({data}) => this.receive(data);
    this.socket.onclose = () => this.reconnect();
    this.heardAt = performance.now();
    this.watch(this.socket);
  }

  /** A socket whose machine slept, or whose network went, says nothing of it. */
  watch(socket, askedAt = 0) {
    if (socket !== this.socket || socket.readyState > WebSocket.OPEN) return;
    const now = performance.now();
    let asked = this.heardAt > askedAt ? 0 : askedAt;
    if (!asked && now - this.heardAt > silence_ms) {
      asked = now;
      if (this.isOpen()) this.ask({do: 'ping'});
    } else if (asked && now - asked > silence_ms) {
      socket.onopen = socket.onmessage = socket.onclose = null;
      socket.close();
      this.reconnect();
      return;
    }
    setTimeout(() => this.watch(socket, asked), silence_ms / 4);
  }

  isOpen() {
    return this.socket.readyState === WebSocket.OPEN;
  }

  reconnect() {
    for (const answer of this.answers.values()) answer({type: 'refused', why: 'The connection was lost.'});
    this.answers.clear();
    this.opened(false);
    setTimeout(() => this.connect(), this.wait_ms);
    this.wait_ms = Math.min(4000, 2 * this.wait_ms);
  }

  async receive(data) {
    this.heardAt = performance.now();
    const {header, parts} = typeof data === 'string' ? {header: JSON.parse(data), parts: []} : unpack(data);
    if ('id' in header) {
      this.answers.get(header.id)?.(header);
      this.answers.delete(header.id);
      return;
    }
    const socket = this.socket;
    try {
      await this.take(header, parts);
    } finally {
      if (socket.readyState === WebSocket.OPEN) socket.send('seen');
    }
  }

  /** The answer to a request. */
  ask(request) {
    if (!this.isOpen()) return Promise.resolve({type: 'refused', why: 'Not connected.'});
    const id = ++this.ids;
    this.socket.send(JSON.stringify({...request, id}));
    return new Promise((resolve) => { this.answers.set(id, resolve); });
  }
}

/** Settings on their way: one request at a time, with the newest value of each key. */
class Sender {
  constructor(link) {
    Object.assign(this, {link, waiting: new Map(), isBusy: false});
  }

  /** `done(answer)` is called with the answer, unless a newer value of the key took its place. */
  set(key, text, done = () => {}) {
    this.waiting.set(key, {text, done, since: performance.now()});
    if (!this.isBusy) this.send();
  }

  async send() {
    this.isBusy = true;
    while (this.waiting.size > 0) {
      const batch = [...this.waiting];
      this.waiting.clear();
      const answer = await this.link.ask({do: 'set', settings: batch.map(([key, {text}]) => `${key}=${text}`)});
      for (const [, {done, since}] of batch) done({...answer, since});
    }
    this.isBusy = false;
  }
}
